// Cost of dds_gateway, compared with a bare LCM subscriber and a bare DDS writer in the same run:
// latency of small messages at 1 kHz, CPU, and the effect of a frozen subscriber on the others.
//   gateway_benchmark FOLDER_OF_PROGRAMS RESULT.csv     (in tests/in_private_network.sh)
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <lab/robot_status_t.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/math/percentiles.hpp"
#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/ros/ros_type.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using namespace lab;
using Clock = std::chrono::steady_clock;

constexpr int kDomain = 43;
constexpr auto kPeriod = std::chrono::milliseconds(1);
constexpr double kSettle = 4;    // [s]
constexpr double kMeasure = 20;  // [s]
constexpr double kFrozen = 14;   // [s] longer than Cyclone's lease of 10 s
const std::string kUrl = lcmUrl(7903);
constexpr const char* kThrough = "/lab/robot1/light";
constexpr const char* kPlain = "/plain/light";
constexpr const char* kReader = "--reader";

std::int64_t wallMicroseconds() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

pid_t child(const std::function<void()>& work) {
  const pid_t pid = fork();
  if (pid == 0) {
    work();
    _exit(0);
  }
  return pid;
}

/// Calls `act` at 1 kHz until it returns false.
void everyMillisecond(const std::function<bool()>& act) {
  auto next = Clock::now();
  while (act()) {
    next += kPeriod;
    std::this_thread::sleep_until(next);
  }
}

ros::Illuminance sample(std::int64_t utime) {
  static char frame[] = "lab/robot1";
  return {{{static_cast<std::int32_t>(utime / 1'000'000),
            static_cast<std::uint32_t>(utime % 1'000'000 * 1000)},
           frame},
          0.5,
          0};
}

void bareSubscriber() {
  LcmBus bus(kUrl);
  std::size_t bytes = 0;
  bus.subscribe(channels::kRobotStatus,
                [&bytes](const Packet& packet) { bytes += packet.data.size(); });
  for (;;) bus.drainFor(1000);
}

void bareWriter() {
  const dds::Domain domain(kDomain, dds::localConfiguration(), "plain");
  const auto& type = ros::rosType<ros::Illuminance>();
  dds::Writer writer(domain, *type.descriptor, ros::topicName(kPlain), ros::defaultQos(type));
  everyMillisecond([&writer] {
    const ros::Illuminance message = sample(wallMicroseconds());
    writer.write(&message);
    return true;
  });
}

/// Reads a topic for ever; writes a byte to a pipe after 100 messages.
void bareReader(int pipe) {
  const dds::Domain domain(kDomain, dds::localConfiguration(), "reader");
  const auto& type = ros::rosType<ros::Illuminance>();
  EventDescriptor waker;
  dds::Reader reader(domain, *type.descriptor, ros::topicName(kThrough), ros::defaultQos(type),
                     waker);
  for (bool reported = false;;) {
    pollfd waiting{waker.get(), POLLIN, 0};
    poll(&waiting, 1, 1000);
    waker.clear();
    reader.take(1000, [](const void*, dds::WriterId) {});
    if (!reported && reader.received() > 100) reported = write(pipe, "r", 1) == 1;
  }
}

/// bareReader() in its own process, because this process has already joined the domain.
class FrozenReader {
 public:
  explicit FrozenReader(char* program) {
    int ends[2];
    if (pipe(ends) != 0) return;
    const std::string end = std::to_string(ends[1]);
    pid_ = child([&] {
      execl("/proc/self/exe", program, kReader, end.c_str(), nullptr);
      _exit(127);
    });
    close(ends[1]);
    heard_ = ends[0];
  }
  ~FrozenReader() {
    close(heard_);
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  FrozenReader(const FrozenReader&) = delete;
  FrozenReader& operator=(const FrozenReader&) = delete;

  /// Whether messages arrive within 10 s.
  [[nodiscard]] bool reads() const {
    pollfd waiting{heard_, POLLIN, 0};
    char byte = 0;
    return poll(&waiting, 1, 10'000) == 1 && read(heard_, &byte, 1) == 1;
  }
  void freeze() const { kill(pid_, SIGSTOP); }
  /// Whether the process exists and is stopped.
  [[nodiscard]] bool isFrozen() const {
    std::ifstream stream("/proc/" + std::to_string(pid_) + "/stat");
    std::string text;
    std::getline(stream, text);
    const std::size_t name_ends = text.rfind(')');
    return name_ends != std::string::npos && text.substr(name_ends, 3) == ") T";
  }

 private:
  pid_t pid_ = -1;
  int heard_ = -1;
};

/// Delays of received messages [us].
class Delays {
 public:
  void add(std::int64_t utime) {
    if (!recording) return;
    const std::int64_t now = wallMicroseconds();
    values_.push_back(static_cast<double>(now - utime));
    if (last_ != 0) gap_ = std::max(gap_, now - last_);
    last_ = now;
  }
  /// [us]; nan without values.
  [[nodiscard]] Percentiles percentiles() const { return percentilesOf(values_); }
  [[nodiscard]] std::size_t count() const { return values_.size(); }
  /// Longest time between two received messages [us].
  [[nodiscard]] double longestGap() const { return static_cast<double>(gap_); }
  void clear() {
    values_.clear();
    last_ = gap_ = 0;
  }
  std::atomic<bool> recording = false;

 private:
  std::vector<double> values_;
  std::int64_t last_ = 0;  ///< time of the last message
  std::int64_t gap_ = 0;
};

class DdsEnd {
 public:
  DdsEnd(const dds::Domain& domain, const char* topic, std::atomic<bool>& over)
      : reader_(domain, *ros::rosType<ros::Illuminance>().descriptor, ros::topicName(topic),
                ros::defaultQos(ros::rosType<ros::Illuminance>()), waker_),
        thread_([this, &over] {
          while (!over) {
            pollfd waiting{waker_.get(), POLLIN, 0};
            poll(&waiting, 1, 100);
            waker_.clear();
            reader_.take(1000, [this](const void* data, dds::WriterId) {
              const auto& stamp = static_cast<const ros::Illuminance*>(data)->header.stamp;
              delays.add(std::int64_t{stamp.sec} * 1'000'000 + stamp.nanosec / 1000);
            });
          }
        }) {}
  ~DdsEnd() { thread_.join(); }
  Delays delays;

 private:
  EventDescriptor waker_;
  dds::Reader reader_;
  std::thread thread_;
};

/// CPU time of all threads so far [s].
double cpuOf(pid_t pid) {
  double nanoseconds = 0;
  for (const auto& task : fs::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
    double on = 0;
    std::ifstream(task.path() / "schedstat") >> on;
    nanoseconds += on;
  }
  return nanoseconds * 1e-9;
}

void sleepFor(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

pid_t gateway(const fs::path& programs, const fs::path& folder) {
  std::ofstream(folder / "e.toml") << "fileversion = 1\nname = \"gateway\"\nduration_s = 60\n"
                                      "program = \"stand\"\n[gateway]\nros = true\ndomain = "
                                   << kDomain
                                   << "\nmapping = \"m.toml\"\n[[robots]]\nid = 1\n"
                                      "[programs.stand]\nmodel = \"stand\"\n";
  // Rules that pass only this topic.
  std::ofstream(folder / "m.toml") << "fileversion = 1\n[[rules]]\ntopic = \"" << kThrough
                                   << "\"\n[[rules]]\ntopic = \".*\"\nallow = false\n";
  return child([&] {
    execl((programs / "dds_gateway").c_str(), "dds_gateway", "--experiment",
          (folder / "e.toml").c_str(), "--lcm-url", kUrl.c_str(), nullptr);
    _exit(127);
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == kReader) bareReader(std::stoi(argv[2]));
  if (argc != 3) {
    fmt::print(stderr, "usage: {} FOLDER_OF_PROGRAMS RESULT.csv\n", argv[0]);
    return 2;
  }
  const TemporaryFolder folder;
  const pid_t through = gateway(argv[1], folder.path());
  const pid_t subscriber = child(bareSubscriber);
  const pid_t writer = child(bareWriter);
  std::string csv = "what,value,unit\n";
  bool is_invalid = false;
  {
    std::atomic<bool> over = false;
    const dds::Domain domain(kDomain, dds::localConfiguration(), "benchmark");
    DdsEnd both(domain, kThrough, over);
    DdsEnd plain_dds(domain, kPlain, over);
    Delays plain_lcm;
    std::thread listening([&] {
      LcmBus bus(kUrl);
      bus.subscribe(channels::kRobotStatus, [&plain_lcm](const Packet& packet) {
        robot_status_t status{};
        if (decode(packet.data, status)) plain_lcm.add(status.utime);
      });
      while (!over) bus.drainFor(100);
    });
    std::thread publishing([&] {
      LcmBus bus(kUrl);
      robot_status_t status{};
      status.sender = "sim_svc";
      status.robots.resize(1);
      status.num_robots = 1;
      status.robots[0].robot_id = 1;
      everyMillisecond([&] {
        ++status.seq;
        status.utime = status.robots[0].utime = wallMicroseconds();
        bus.publish(channels::kRobotStatus, encode(status));
        return !over.load();
      });
    });
    const auto record = [&](bool on) {
      both.delays.recording = plain_dds.delays.recording = plain_lcm.recording = on;
      sleepFor(0.1);
    };
    sleepFor(kSettle);
    record(true);
    const double gateway_before = cpuOf(through);
    const double subscriber_before = cpuOf(subscriber);
    const double writer_before = cpuOf(writer);
    sleepFor(kMeasure);
    const double gateway_cpu = cpuOf(through) - gateway_before;
    const double bare_cpu = cpuOf(subscriber) - subscriber_before + cpuOf(writer) - writer_before;
    record(false);
    const auto row = [&csv](const std::string& what, double value, const char* unit) {
      csv += fmt::format("{},{:.4g},{}\n", what, value, unit);
    };
    row("messages through the gateway in 20 s", static_cast<double>(both.delays.count()), "1");
    const double lcm = plain_lcm.percentiles().p50;
    const double dds = plain_dds.delays.percentiles().p50;
    const double all = both.delays.percentiles().p50;
    row("plain LCM p50", lcm, "us");
    row("plain DDS p50", dds, "us");
    row("LCM -> gateway -> DDS p50", all, "us");
    row("added p50: gateway - plain LCM", all - lcm, "us");
    row("LCM -> gateway -> DDS p99", both.delays.percentiles().p99, "us");
    row("ratio to plain LCM + plain DDS", all / (lcm + dds), "1");
    row("gateway CPU at 1000 messages/s", 100 * gateway_cpu / kMeasure, "% of one core");
    row("bare LCM subscriber + bare DDS writer", 100 * bare_cpu / kMeasure, "% of one core");
    row("ratio of CPU", gateway_cpu / bare_cpu, "1");

    // Another reader of the topic: running, then frozen for longer than its lease, so that the
    // gateway first waits for it and then drops it. The delays of messages through the gateway show
    // whether that blocks its loop.
    FrozenReader reader(argv[0]);
    is_invalid = !reader.reads();
    const auto watched = [&](const std::string& when) {
      both.delays.clear();
      plain_dds.delays.clear();
      plain_lcm.clear();
      record(true);
      sleepFor(kFrozen);
      record(false);
      row("messages through the gateway: " + when, static_cast<double>(both.delays.count()), "1");
      const std::pair<const char*, Delays*> ends[] = {{"plain LCM", &plain_lcm},
                                                      {"plain DDS", &plain_dds.delays},
                                                      {"LCM -> gateway -> DDS", &both.delays}};
      for (const auto& [name, delays] : ends) {
        const std::string where = fmt::format("{}: {}", name, when);
        row("p50 " + where, delays->percentiles().p50, "us");
        row("longest delay " + where, delays->percentiles().max * 1e-3, "ms");
        row("longest gap between two messages " + where, delays->longestGap() * 1e-3, "ms");
      }
    };
    watched("readers awake");
    reader.freeze();
    sleepFor(0.2);
    is_invalid = is_invalid || !reader.isFrozen();
    watched(fmt::format("one reader frozen {:.0f} s", kFrozen));
    is_invalid = is_invalid || !reader.isFrozen();
    over = true;
    publishing.join();
    listening.join();
  }
  for (const pid_t pid : {through, subscriber, writer}) {
    kill(pid, SIGTERM);
    waitpid(pid, nullptr, 0);
  }
  if (is_invalid) {
    fmt::print(stderr, "{}invalid: the reader to be frozen received nothing or ended\n", csv);
    return 1;
  }
  fmt::print("{}", csv);
  fs::create_directories(fs::path(argv[2]).parent_path());
  std::ofstream(argv[2]) << csv;
  return 0;
}
