// ROS 2 tools connect and disconnect for hours: the gateway's memory must not grow, and every topic
// must still work afterwards.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/dds_gateway/ros/ros_gateway_fixture.hpp"

namespace lab::gateway {
namespace {

// A sanitizer keeps freed memory for a while, to find its use.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kKeepsFreedMemory = true;
#else
constexpr bool kKeepsFreedMemory = false;
#endif

constexpr int kRobots = 66;  // with pose, odom and light: 198 topics, and the lab's own
constexpr int kReaders = 20;

/// [kB] resident memory.
long residentMemory(pid_t pid) {
  std::ifstream stream("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
  }
  return 0;
}

struct Reading {
  virtual ~Reading() = default;
  virtual int take() = 0;
};
template <class Message>
struct ReadingOf final : Reading {
  ReadingOf(const dds::Domain& domain, const std::string& topic, bool latched)
      : reader(domain, topic, latched) {}
  int take() override {
    return reader.take([](const Message&) {});
  }
  RosReader<Message> reader;
};

std::unique_ptr<Reading> readerOf(const dds::Domain& domain, int robot, int kind) {
  const std::string name = "/lab/robot" + std::to_string(robot) + "/";
  switch (kind) {
    case 0:
      return std::make_unique<ReadingOf<ros::PoseStamped>>(domain, name + "pose", true);
    case 1:
      return std::make_unique<ReadingOf<ros::Odometry>>(domain, name + "odom", false);
    default:
      return std::make_unique<ReadingOf<ros::Illuminance>>(domain, name + "light", false);
  }
}

class RosChurn : public ::testing::Test {
 protected:
  /// Twenty readers of 200 topics; each `period` [s] replaces the oldest five by new ones.
  void churn(double seconds, double period) {
    double next = 0;
    dut_.spinActing(seconds, std::min(0.1, period), [&] {
      publish();
      for (const auto& reader : readers_) received_ += reader->take();
      const double now = static_cast<double>(dut_.now()) * 1e-6;
      if (now < next) return;
      next = now + period;
      for (int i = 0; i < 5; ++i) {
        if (readers_.size() >= kReaders) readers_.pop_front();
        readers_.push_back(readerOf(dut_.domain(), 1 + static_cast<int>(random_() % kRobots),
                                    static_cast<int>(random_() % 3)));
        ++made_;
      }
    });
  }

  void publish() {
    auto status = statusOf(kRobots, dut_.now());
    dut_.node().publish(channels::kRobotStatus, status);
    auto frame = frameOf(kRobots, dut_.now(), ++frame_);
    dut_.node().publish(channels::kTrackedFrame, frame);
  }

  RosGatewayFixture dut_;
  std::deque<std::unique_ptr<Reading>> readers_;
  std::mt19937 random_{1};
  std::int64_t frame_ = 0;
  std::int64_t received_ = 0;
  int made_ = 0;

  /// Memory after a warm-up, and its growth within the given time [kB]. Reused memory reaches its
  /// size after about 4500 readers.
  void run(double warm_up, double warm_up_period, double seconds, long most_growth) {
    churn(warm_up, warm_up_period);
    const long before = residentMemory(dut_.gatewayPid());
    churn(seconds, 0.5);
    const long after = residentMemory(dut_.gatewayPid());
    RecordProperty("before_kB", static_cast<int>(before));
    RecordProperty("after_kB", static_cast<int>(after));
    std::printf("%d readers, %ld samples, memory %ld kB -> %ld kB\n", made_,
                static_cast<long>(received_), before, after);
    EXPECT_GT(before, 0);
    if (!kKeepsFreedMemory) {
      EXPECT_LT(after - before, most_growth);
    }
    everyTopicWorks();
  }

  void everyTopicWorks() {
    readers_.clear();
    std::vector<std::unique_ptr<Reading>> all;
    for (int robot = 1; robot <= kRobots; ++robot) {
      for (int kind = 0; kind < 3; ++kind) all.push_back(readerOf(dut_.domain(), robot, kind));
    }
    std::vector<int> got(all.size(), 0);
    dut_.spinActing(
        20, 0.1, [&] { publish(); },
        [&] {
          for (std::size_t i = 0; i < all.size(); ++i) got[i] += all[i]->take();
          return std::all_of(got.begin(), got.end(), [](int count) { return count > 0; });
        });
    EXPECT_EQ(std::count(got.begin(), got.end(), 0), 0) << "topics without a word";
  }
};

TEST_F(RosChurn, Short) { run(10, 0.5, 10, 1024); }

// Ten minutes with 6000 readers, after 7000 in the warm-up: a leak of 100 bytes each would be 600
// kB.
TEST_F(RosChurn, Long) { run(75, 0.05, 600, 512); }

}  // namespace
}  // namespace lab::gateway
