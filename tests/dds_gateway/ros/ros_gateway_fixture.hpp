/// Runs a gateway in a private network and plays both its sides, the lab and ROS 2.
#pragma once

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <fstream>
#include <functional>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/service/node.hpp"
#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/ros/ros_type.hpp"
#include "runner/yielded_robots.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::gateway {

/// A child process that ends with the object.
class Program {
 public:
  explicit Program(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawn(&pid_, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) {
      throw std::runtime_error("cannot start " + words.front());
    }
  }
  ~Program() { end(SIGTERM); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// @return the exit code
  int end(int with) {
    if (pid_ <= 0) return -1;
    kill(pid_, with);
    return wait();
  }
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  pid_t pid_ = -1;
};

inline constexpr const char* kTwoRobots = R"(
fileversion = 1
name = "ros_test"
duration_s = 600
program = "abp"
[gateway]
ros = true
domain = 41
commands = true
[robot]
pwm_steps = false
clock_error_percent = 0
[[robots]]
id = 1
x_cm = 30
y_cm = 30
theta_deg = 0
[[robots]]
id = 2
x_cm = 30
y_cm = 60
theta_deg = 0
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
[programs.straight]
model = "wheels"
left_cm_s = 2
right_cm_s = 2
)";

/// kTwoRobots with an additional line in its [gateway].
inline std::string withGatewayLine(const std::string& line) {
  std::string text = kTwoRobots;
  const std::string mark = "[gateway]\n";
  return text.insert(text.find(mark) + mark.size(), line + "\n");
}

/// ROS 2's reader of one topic; keeps the samples of the last read.
template <class Message>
class RosReader {
 public:
  RosReader(const dds::Domain& domain, const std::string& topic, bool latched = false)
      : reader_(domain, *ros::rosType<Message>().descriptor, ros::topicName(topic),
                latched ? ros::latchedQos(ros::rosType<Message>())
                        : ros::defaultQos(ros::rosType<Message>()),
                waker_) {}
  /// Calls `look` with every sample that has arrived. @return their number
  int take(const std::function<void(const Message&)>& look) {
    return reader_.take(1000, [&look](const void* sample, dds::WriterId) {
      look(*static_cast<const Message*>(sample));
    });
  }
  [[nodiscard]] dds::Matching matching() const { return reader_.matching(); }

 private:
  EventDescriptor waker_;
  dds::Reader reader_;
};

template <class Message>
class RosWriter {
 public:
  RosWriter(const dds::Domain& domain, const std::string& topic, bool reliable = true)
      : writer_(domain, *ros::rosType<Message>().descriptor, ros::topicName(topic),
                reliable ? ros::defaultQos(ros::rosType<Message>())
                         : ros::sensorQos(ros::rosType<Message>())) {}
  void write(const Message& message) { writer_.write(&message); }
  [[nodiscard]] dds::Matching matching() const { return writer_.matching(); }

 private:
  dds::Writer writer_;
};

/// The gateway, optionally sim_svc, and a lab that orders the light table at 5 Hz.
class RosGatewayFixture {
 public:
  /// @param mapping text of mapping.toml, if the experiment names one
  explicit RosGatewayFixture(const std::string& experiment = kTwoRobots, bool simulated = false,
                             const std::string& mapping = "")
      : file_((folder_ / "experiment.toml").string()) {
    std::ofstream(file_) << experiment;
    if (!mapping.empty()) std::ofstream(folder_ / "mapping.toml") << mapping;
    experiment_ = loadExperiment(file_);
    table_ = lightTableCommand(experiment_);
    node_.subscribe<robot_status_t>(channels::kRobotStatus, [this](const robot_status_t& status) {
      for (const robot_state_t& robot : status.robots) states_[robot.robot_id] = robot;
    });
    node_.subscribe<service_status_t>(
        channels::kServiceStatus,
        [this](const service_status_t& status) { services_[status.sender] = status; });
    node_.subscribe<robot_command_t>(channels::kRobotCommand,
                                     [this](const robot_command_t& command) {
                                       if (command.sender != "lab")
                                         yielded_.take(command, loop_.now());
                                     });
    gateway_ = start("dds_gateway");
    if (simulated) sim_ = start("sim_svc");
    const bool up =
        spin(10, [&] { return isReady("dds_gateway") && (!simulated || isReady("sim_svc")); });
    if (!up) throw std::runtime_error("the programs do not get ready");
  }

  /// Runs until `done` or for at most `seconds`. @return whether it was done
  bool spin(
      double seconds, const std::function<bool()>& done = [] { return false; }) {
    const std::int64_t end = loop_.now() + static_cast<std::int64_t>(seconds * 1e6);
    while (!done()) {
      if (loop_.now() >= end) return false;
      if (sim_ && loop_.now() - ordered_utime_ > 200'000) {
        ordered_utime_ = loop_.now();
        robot_command_t command = yielded_.without(table_, loop_.now());
        command.utime = 0;
        command.seq = 1;
        node_.publishCommand(channels::kRobotCommand, command);
      }
      bus_.drainFor(5);
    }
    return true;
  }

  /// The same, and calls `act` periodically.
  bool spinActing(
      double seconds, double period, const std::function<void()>& act,
      const std::function<bool()>& done = [] { return false; }) {
    std::int64_t next = 0;
    return spin(seconds, [&] {
      if (loop_.now() >= next) {
        act();
        next = loop_.now() + static_cast<std::int64_t>(period * 1e6);
      }
      return done();
    });
  }

  [[nodiscard]] bool isReady(const std::string& service) const {
    const auto status = services_.find(service);
    return status != services_.end() && status->second.state == service_status_t::READY;
  }
  [[nodiscard]] std::string lastError() const {
    const auto status = services_.find("dds_gateway");
    return status == services_.end() ? "" : status->second.last_error;
  }
  [[nodiscard]] const robot_state_t& state(std::int32_t id) { return states_[id]; }
  [[nodiscard]] bool driven(std::int32_t id, double v) {
    return std::abs(states_[id].wheel_left - v) < 1e-4 &&
           std::abs(states_[id].wheel_right - v) < 1e-4 && states_[id].robot_id == id;
  }
  /// Whether the robot runs its program by the lab's light table.
  [[nodiscard]] bool inScript(std::int32_t id) {
    return states_[id].program.name == "abp" && states_[id].robot_id == id;
  }

  /// The last /diagnostics within `seconds`, as "name: message {key: value}" lines.
  std::string diagnostics(double seconds = 2.5) {
    RosReader<ros::DiagnosticArray> reader(domain_, "/diagnostics");
    std::string text;
    spin(seconds, [&] {
      reader.take([&](const ros::DiagnosticArray& array) {
        text.clear();
        for (std::uint32_t i = 0; i < array.status._length; ++i) {
          const ros::DiagnosticStatus& status = array.status._buffer[i];
          text += std::string(status.name) + ": " + status.message + "\n";
          for (std::uint32_t j = 0; j < status.values._length; ++j) {
            const ros::KeyValue& value = status.values._buffer[j];
            text += "  " + std::string(value.key) + ": " + value.value + "\n";
          }
        }
      });
      return false;
    });
    return text;
  }

  /// Publishes a closing SERVICE_STATUS as `lab mark` does.
  void endCommandByHand() { Node(bus_, loop_, {"lab_mark", 0, loop_.now()}).close(); }

  /// Publishes a SERVICE_STATUS of another service.
  void reportService(const std::string& name) { Node(bus_, loop_, {name, 0, loop_.now()}).ready(); }

  [[nodiscard]] const dds::Domain& domain() const { return domain_; }
  [[nodiscard]] Node& node() { return node_; }
  [[nodiscard]] std::int64_t now() const { return loop_.now(); }
  [[nodiscard]] pid_t gatewayPid() const { return gateway_->pid(); }

 private:
  std::unique_ptr<Program> start(const std::string& name) {
    return std::make_unique<Program>(std::vector<std::string>{
        std::string(LAB_PROGRAMS) + "/" + name, "--experiment", file_, "--lcm-url", url_});
  }

  TemporaryFolder folder_;
  std::string file_;
  std::string url_ = lcmUrl(7901);
  Experiment experiment_;
  robot_command_t table_;
  AsioLoop loop_;
  LcmBus bus_{url_};
  Node node_{bus_, loop_, {"lab", 0, loop_.now()}};
  dds::Domain domain_{41, dds::localConfiguration(), "test"};
  runner::YieldedRobots yielded_;
  std::int64_t ordered_utime_ = 0;
  std::map<std::int32_t, robot_state_t> states_;
  std::map<std::string, service_status_t> services_;
  std::unique_ptr<Program> gateway_;
  std::unique_ptr<Program> sim_;
};

/// A frame with robots 1 .. count in a row.
inline tracked_frame_t frameOf(int count, std::int64_t utime, std::int64_t number) {
  tracked_frame_t frame{};
  frame.utime = utime;
  frame.frame = number;
  frame.frame_period = 0.02;
  for (int i = 1; i <= count; ++i) {
    tracked_pose_t pose{};
    pose.robot_id = i;
    pose.x = 0.1 * i;
    pose.y = 0.5;
    pose.confidence = 1;
    frame.robots.push_back(pose);
  }
  frame.num_robots = count;
  return frame;
}

inline robot_status_t statusOf(int count, std::int64_t utime) {
  robot_status_t status{};
  status.utime = utime;
  for (int i = 1; i <= count; ++i) {
    robot_state_t state{};
    state.utime = utime;
    state.robot_id = i;
    state.origin = robot_state_t::SIM;
    state.wheel_left = 0.1;
    state.wheel_right = 0.1;
    state.light_front = 0.5F;
    state.light_back = 0.5F;
    status.robots.push_back(state);
  }
  status.num_robots = count;
  return status;
}

inline light_status_t uniformLight(double intensity, std::int64_t utime) {
  light_status_t status{};
  status.utime = utime;
  status.first_shown_utime = utime;
  status.mix = 1;
  light_layer_t layer{};
  layer.kind = light_layer_t::UNIFORM;
  layer.intensity = intensity;
  status.layers = {layer};
  status.num_layers = 1;
  return status;
}

}  // namespace lab::gateway
