// What dds_gateway costs, beside a bare LCM subscriber and a bare DDS writer in the same run:
// latency of small messages at 1 kHz, CPU, and what a frozen subscriber does to the others.
//   gateway_benchmark FOLDER_OF_PROGRAMS RESULT.csv     (within tests/in_private_network.sh)
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <lab/robot_status_t.hpp>
#include <string_view>
#include <thread>
#include <vector>

#include "common/channels.hpp"
#include "common/lcm_bus.hpp"
#include "dds/configuration.hpp"
#include "dds/domain.hpp"
#include "dds/endpoint.hpp"
#include "ros_types/ros_type.hpp"

namespace {

namespace fs = std::filesystem;
using namespace lab;
using Clock = std::chrono::steady_clock;

constexpr int kDomain = 43;
constexpr auto kPeriod = std::chrono::milliseconds(1);
constexpr double kSettle = 4;    // [s]
constexpr double kMeasure = 20;  // [s]
constexpr double kFrozen = 5;    // [s] below Cyclone's lease of 10 s
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

/// Calls `act` at 1 kHz for ever.
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

/// Reads a topic until somebody freezes it.
void bareReader() {
  const dds::Domain domain(kDomain, dds::localConfiguration(), "reader");
  const auto& type = ros::rosType<ros::Illuminance>();
  dds::Waker waker;
  dds::Reader reader(domain, *type.descriptor, ros::topicName(kThrough), ros::defaultQos(type),
                     waker);
  for (;;) {
    pollfd waiting{waker.fileDescriptor(), POLLIN, 0};
    poll(&waiting, 1, 1000);
    waker.quiet();
    reader.take(1000, [](const void*, dds::WriterId) {});
  }
}

/// Delays of what arrives [us].
class Delays {
 public:
  void add(std::int64_t utime) {
    const std::int64_t delay = wallMicroseconds() - utime;
    if (recording) values_.push_back(delay);
  }
  [[nodiscard]] double quantile(double share) {
    if (values_.empty()) return -1;
    std::sort(values_.begin(), values_.end());
    return static_cast<double>(
        values_[static_cast<std::size_t>(share * static_cast<double>(values_.size() - 1))]);
  }
  [[nodiscard]] std::size_t count() const { return values_.size(); }
  void clear() { values_.clear(); }
  std::atomic<bool> recording = false;

 private:
  std::vector<std::int64_t> values_;
};

class DdsEnd {
 public:
  DdsEnd(const dds::Domain& domain, const char* topic, std::atomic<bool>& over)
      : reader_(domain, *ros::rosType<ros::Illuminance>().descriptor, ros::topicName(topic),
                ros::defaultQos(ros::rosType<ros::Illuminance>()), waker_),
        thread_([this, &over] {
          while (!over) {
            pollfd waiting{waker_.fileDescriptor(), POLLIN, 0};
            poll(&waiting, 1, 100);
            waker_.quiet();
            reader_.take(1000, [this](const void* data, dds::WriterId) {
              const auto& stamp = static_cast<const ros::Illuminance*>(data)->header.stamp;
              delays.add(std::int64_t{stamp.sec} * 1'000'000 + stamp.nanosec / 1000);
            });
          }
        }) {}
  ~DdsEnd() { thread_.join(); }
  Delays delays;

 private:
  dds::Waker waker_;
  dds::Reader reader_;
  std::thread thread_;
};

/// CPU of all threads so far [s].
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
  // One message in, one message out.
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
  if (argc == 2 && std::string_view(argv[1]) == kReader) bareReader();
  if (argc != 3) {
    fmt::print(stderr, "usage: {} FOLDER_OF_PROGRAMS RESULT.csv\n", argv[0]);
    return 2;
  }
  const fs::path folder = fs::temp_directory_path() / fmt::format("gateway_{}", getpid());
  fs::create_directories(folder);
  const pid_t through = gateway(argv[1], folder);
  const pid_t subscriber = child(bareSubscriber);
  const pid_t writer = child(bareWriter);
  std::string csv = "what,value,unit\n";
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
    const double lcm = plain_lcm.quantile(0.5);
    const double dds = plain_dds.delays.quantile(0.5);
    const double all = both.delays.quantile(0.5);
    row("plain LCM p50", lcm, "us");
    row("plain DDS p50", dds, "us");
    row("LCM -> gateway -> DDS p50", all, "us");
    row("LCM -> gateway -> DDS p99", both.delays.quantile(0.99), "us");
    row("added to plain LCM p50", all - lcm, "us");
    row("ratio to plain LCM + plain DDS", all / (lcm + dds), "1");
    row("gateway CPU at 1000 messages/s", 100 * gateway_cpu / kMeasure, "% of one core");
    row("bare LCM subscriber + bare DDS writer", 100 * bare_cpu / kMeasure, "% of one core");
    row("ratio of CPU", gateway_cpu / bare_cpu, "1");
    const double calm = both.delays.quantile(1);

    // As a program of its own: this one is in the domain already.
    const pid_t frozen = child([argv] {
      execl("/proc/self/exe", argv[0], kReader, nullptr);
      _exit(127);
    });
    sleepFor(3);
    kill(frozen, SIGSTOP);
    sleepFor(0.2);
    both.delays.clear();
    record(true);
    sleepFor(kFrozen);
    record(false);
    row("largest delay of another reader before", calm * 1e-3, "ms");
    row("largest delay of another reader while one is frozen", both.delays.quantile(1) * 1e-3,
        "ms");
    row("its p99", both.delays.quantile(0.99), "us");
    row("the frozen reader was there (1: yes)", waitpid(frozen, nullptr, WNOHANG) == 0 ? 1 : 0,
        "1");
    row("messages it got in 5 s", static_cast<double>(both.delays.count()), "1");
    kill(frozen, SIGKILL);
    waitpid(frozen, nullptr, 0);
    over = true;
    publishing.join();
    listening.join();
  }
  for (const pid_t pid : {through, subscriber, writer}) {
    kill(pid, SIGTERM);
    waitpid(pid, nullptr, 0);
  }
  fs::remove_all(folder);
  fmt::print("{}", csv);
  fs::create_directories(fs::path(argv[2]).parent_path());
  std::ofstream(argv[2]) << csv;
  return 0;
}
