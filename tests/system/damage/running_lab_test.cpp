// A running lab with all its processes hears mutated messages: nothing dies, and the run can be
// analyzed. LAB_MUTANTS sets their number, LAB_MUTANT the first one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <lab/experiment_command_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/service_status_t.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/bus/message_header.hpp"
#include "common/loop/wall_clock.hpp"
#include "tests/support/lab_process.hpp"
#include "tests/support/mutated_log.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kPort = 24701;
constexpr const char* kServices[] = {"sim_svc",     "robot_bridge", "projector_ctl", "tracker_svc",
                                     "dds_gateway", "analyzer",     "dashboard",     "recorder"};
constexpr std::uint64_t kBatch = 5000;         // mutants between two checks
constexpr std::size_t kChannels = 15;          // with messages in an undisturbed run, and requests
constexpr std::size_t kSamplesOfChannel = 30;  // messages that are mutated
constexpr const char* kMark = "BATCH_END";     // no channel of the lab

/// Every process of a lab: robots on the bus and on the wire, painted frames, ROS 2.
constexpr std::string_view kExperiment = R"(fileversion = 1
name = "mutated"
duration_s = 100000
[network]
port = 24701
[gateway]
ros = true
commands = true
[[robots]]
id = 1
count = 3
[[robots]]
id = 7
body = "wire"
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
[programs.rtp]
model = "rtp"
v_cm_s = 5
gamma_per_s = 3
tau_t_s = 0.5
[light_table]
bands = [{light = [0.0, 0.5], program = "abp"}, {light = [0.5, 1.0], program = "rtp"}]
[[light.steps]]
hold_s = 100000
layers = [{kind = "half_plane", x_cm = 60, y_cm = 45, intensity = 0.8}]
[camera]
tracker = "camera"
camera = "sim"
fps = 10
width_px = 640
height_px = 360
)";

/// A lab that is started again when a mutant has ended its run, which some may do: a forged owner
/// of a robot, and requests of an operator.
class RunningLab {
 public:
  explicit RunningLab(const fs::path& folder) : folder_(folder), file_(folder / "mutated.toml") {
    setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
    std::ofstream(file_) << kExperiment;
    bus_.subscribeAll([this](const Packet& packet) { hear(packet); });
  }

  void start() {
    ++starts_;
    lab_.emplace("exec lab run " + file_.string() + " --web --no-report --out " + runs().string());
    ASSERT_TRUE(waitUntil(
        [this] {
          bus_.drain();
          return lab_->output().find("running ") != std::string::npos || !lab_->running();
        },
        seconds(60)))
        << lab_->output();
    ASSERT_TRUE(lab_->running()) << lab_->output();
    pids_.clear();
    for (const char* name : kServices) pids_[name] = pidOf(name);
    samples_.clear();
    addRequests();
    sampling_ = true;
    const auto begin = steady_clock::now();
    while (steady_clock::now() < begin + seconds(2) ||
           (samples_.size() < kChannels && steady_clock::now() < begin + seconds(30))) {
      bus_.drainFor(20);
    }
    sampling_ = false;
    ASSERT_GE(samples_.size(), kChannels);
  }

  [[nodiscard]] std::vector<std::string> channels() const {
    std::vector<std::string> names;
    for (const auto& [name, messages] : samples_) names.push_back(name);
    return names;
  }

  /// Sends mutants of what it has heard.
  /// @param only on this channel; empty: on all
  /// @return the time that it took
  std::chrono::duration<double> send(std::uint64_t first, std::uint64_t count, double per_second,
                                     const std::string& only = "") {
    std::vector<RecordedMessage> messages;
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
      messages.push_back(mutantOf(seed, only));
    }
    const auto begin = steady_clock::now();
    for (std::size_t i = 0; i < messages.size(); ++i) {
      std::this_thread::sleep_until(begin +
                                    std::chrono::duration_cast<steady_clock::duration>(
                                        std::chrono::duration<double>(double(i) / per_second)));
      bus_.publish(messages[i].channel, messages[i].data);
    }
    return steady_clock::now() - begin;
  }

  /// Waits until each service has sent a heartbeat after it had heard all that was sent before.
  void check(const std::string& what) {
    heard_ = false;
    reporting_.clear();
    const auto give_up = steady_clock::now() + seconds(60);
    auto again = steady_clock::now();
    const auto all_report = [this] {
      return std::ranges::all_of(kServices, [this](const char* name) {
        return reporting_.contains({name, pids_[name]});
      });
    };
    while (lab_->running() && !all_report() && steady_clock::now() < give_up) {
      if (steady_clock::now() >= again) {
        const std::uint8_t nothing = 0;
        bus_.publish(kMark, {&nothing, 1});
        again += seconds(1);
      }
      bus_.drainFor(20);
    }
    // A run that a mutant has ended may still be ending.
    const auto same_services = [this] {
      return std::ranges::all_of(kServices,
                                 [this](const char* name) { return pidOf(name) == pids_[name]; });
    };
    if (!same_services()) waitUntil([this] { return !lab_->running(); }, seconds(60));
    if (!lab_->running()) return;
    for (const char* name : kServices) {
      EXPECT_TRUE(reporting_.contains({name, pids_[name]})) << name << " is silent after " << what;
      EXPECT_EQ(pidOf(name), pids_[name]) << name << " was restarted after " << what;
    }
    EXPECT_THAT(lab_->output(), Not(HasSubstr(" died ("))) << what;
  }

  [[nodiscard]] bool running() { return lab_->running(); }

  /// Sends the state of a robot with another sender. @return how the run ended
  Finished forgeOwner() {
    constexpr std::size_t kSender = 20;
    RecordedMessage forged = samples_.at(std::string(channels::kRobotStatus)).front();
    forged.data[kSender] = 0x8E;  // no UTF-8
    const auto give_up = steady_clock::now() + seconds(30);
    while (lab_->running() && steady_clock::now() < give_up) {
      setUtime(forged, wallClock());
      bus_.publish(forged.channel, forged.data);
      bus_.drainFor(100);
    }
    return lab_->wait(seconds(60));
  }

  [[nodiscard]] fs::path theRun() const { return onlyRun(runs()); }

  /// Ends the run, if it still runs, and analyzes it.
  void finish(const std::string& what) {
    if (lab_->running()) lab_->signal(SIGINT);
    const Finished ended = lab_->wait(seconds(60));
    EXPECT_THAT(ended.exit_code, AnyOf(0, 3)) << what << "\n" << ended.output;
    EXPECT_THAT(ended.output, Not(HasSubstr(" died ("))) << what;
    const Finished analysis =
        run("lab analyze --no-figures " + onlyRun(runs()).string(), seconds(600));
    EXPECT_EQ(analysis.exit_code, 0) << what << "\n" << analysis.output;
    fs::remove_all(runs());
  }

  [[nodiscard]] int starts() const { return starts_; }

 private:
  [[nodiscard]] fs::path runs() const { return folder_ / "runs"; }

  [[nodiscard]] pid_t pidOf(const std::string& name) const {
    const std::vector<pid_t> found = childrenWith(lab_->pid(), "/" + name);
    return found.size() == 1 ? found.front() : -1;
  }

  void hear(const Packet& packet) {
    if (packet.channel == kMark) {
      heard_ = true;
      return;
    }
    service_status_t status{};
    if (heard_ && packet.channel == channels::kServiceStatus && decode(packet.data, status)) {
      reporting_.emplace(status.sender, status.pid);
    }
    if (!sampling_) return;
    std::vector<RecordedMessage>& known = samples_[std::string(packet.channel)];
    if (known.size() >= kSamplesOfChannel) return;
    known.push_back({std::string(packet.channel), {packet.data.begin(), packet.data.end()}, 0});
  }

  template <class Message>
  void addRequest(std::string_view channel, Message message) {
    message.sender = "mutant";
    message.instance = 1;
    message.seq = 1;
    samples_[std::string(channel)].push_back({std::string(channel), encode(message), 0});
  }

  /// What is not on the bus of an undisturbed run.
  void addRequests() {
    robot_stop_t stop{};
    stop.reason = "mutant";
    addRequest(channels::kRobotStop, stop);
    light_command_t light{};
    light.layers.resize(1);
    light.num_layers = 1;
    addRequest(channels::kLightCommand, light);
    experiment_command_t mark{};
    mark.action = experiment_command_t::MARK;
    addRequest(channels::kExperimentCommand, mark);
  }

  [[nodiscard]] RecordedMessage mutantOf(std::uint64_t seed, const std::string& only) const {
    const auto& channel = !only.empty()
                              ? samples_.find(only)
                              : std::next(samples_.begin(), std::ptrdiff_t(seed % samples_.size()));
    const std::vector<RecordedMessage>& known = channel->second;
    RecordedMessage fresh = known[seed / samples_.size() % known.size()];
    setUtime(fresh, wallClock());
    RecordedMessage message = mutant(fresh, seed);
    // Another owner of a robot ends the run: that is tried now and then.
    constexpr std::uint64_t kSeldom = 20'000;
    if (message.channel == channels::kRobotStatus && seed % kSeldom != 0 &&
        ownerOf(message) != ownerOf(fresh)) {
      return fresh;
    }
    return message;
  }

  static std::pair<std::string, std::int64_t> ownerOf(const RecordedMessage& message) {
    const auto header = peekHeader(message.data);
    if (!header) return {};
    return {std::string(header->sender), header->instance};
  }

  fs::path folder_;
  fs::path file_;
  LcmBus bus_{lcmUrl(kPort)};
  std::optional<Background> lab_;
  int starts_ = 0;
  std::map<std::string, pid_t> pids_;
  std::map<std::string, std::vector<RecordedMessage>> samples_;  ///< by channel
  bool sampling_ = false;
  bool heard_ = false;  ///< the mark after the last mutant
  std::set<std::pair<std::string, pid_t>> reporting_;
};

/// @param per_second mutants
void mutate(double per_second, std::uint64_t usual) {
  const MutantRange range = mutants(usual);
  const TemporaryFolder folder;
  RunningLab lab(folder.path());
  std::chrono::duration<double> sending{};
  const auto begin = steady_clock::now();
  lab.start();
  std::uint64_t sent = 0;
  while (sent < range.count && !testing::Test::HasFailure()) {
    const std::uint64_t first = range.first + sent;
    const std::uint64_t count = std::min(kBatch, range.count - sent);
    const std::string what =
        "LAB_MUTANT=" + std::to_string(first) + " LAB_MUTANTS=" + std::to_string(count);
    sending += lab.send(first, count, per_second);
    sent += count;
    lab.check(what);
    if (lab.running()) continue;
    lab.finish(what);
    if (sent < range.count) lab.start();
  }
  if (lab.running()) lab.finish("all mutants");
  const std::chrono::duration<double> all = steady_clock::now() - begin;
  std::printf("%llu mutants at %.0f /s, %d runs, %.0f s altogether\n",
              static_cast<unsigned long long>(sent), double(sent) / sending.count(), lab.starts(),
              all.count());
}

TEST(RunningLab, RecordsAForgedOwnerWhoseNameIsNoText) {
  const TemporaryFolder folder;
  RunningLab lab(folder.path());
  lab.start();
  const Finished ended = lab.forgeOwner();
  EXPECT_EQ(ended.exit_code, 3) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("has two owners"));
  // A busy machine may add faults of its own.
  const auto faults =
      readJson(lab.theRun() / "provenance.json").at("faults").get<std::vector<std::string>>();
  EXPECT_THAT(faults, testing::Contains(HasSubstr("\uFFFD")));
}

TEST(RunningLab, OutlivesMutatedMessages) { mutate(2000, 3000); }

TEST(RunningLab, OutlivesAFloodOfMutatedMessages) { mutate(20'000, 20'000); }

TEST(RunningLabLong, OutlivesAFloodOnEachChannel) {
  constexpr std::uint64_t kMutants = 20'000;
  constexpr double kPerSecond = 20'000;
  const TemporaryFolder folder;
  RunningLab lab(folder.path());
  lab.start();
  std::chrono::duration<double> sending{};
  std::uint64_t first = mutants(0).first;
  const std::vector<std::string> channels = lab.channels();
  for (const std::string& channel : channels) {
    if (testing::Test::HasFailure()) return;
    sending += lab.send(first, kMutants, kPerSecond, channel);
    first += kMutants;
    lab.check(channel);
    if (lab.running()) continue;
    lab.finish(channel);
    lab.start();
  }
  lab.finish("all channels");
  std::printf("%zu channels, %llu mutants each, at %.0f /s, %d runs\n", channels.size(),
              static_cast<unsigned long long>(kMutants),
              double(channels.size() * kMutants) / sending.count(), lab.starts());
}

}  // namespace
}  // namespace lab::system_test
