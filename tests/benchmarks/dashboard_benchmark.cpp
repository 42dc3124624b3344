// Cost of the dashboard's views: one second of a lab of 100 robots (status and frames at 20 Hz,
// light at 10 Hz), from packets to topics, compared with decoding the same packets.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/experiment/program_messages.hpp"
#include "dashboard/views/lab_view.hpp"
#include "tests/support/programs.hpp"

namespace lab::dashboard {
namespace {

constexpr int kRobots = 100;
constexpr std::int64_t kStart = 1'700'000'000'000'000;
constexpr std::int64_t kTick_us = 50'000;
constexpr int kTicks = 20;  // in one second

struct Sent {
  std::string_view channel;
  std::vector<std::uint8_t> data;
};

template <class Message>
std::vector<std::uint8_t> stamped(Message message, std::int64_t utime, std::int64_t seq) {
  message.utime = utime;
  message.sender = "sim_svc";
  message.instance = 1;
  message.seq = seq;
  return encode(message);
}

Experiment crowd() {
  Experiment experiment;
  experiment.name = "crowd";
  experiment.duration = 60;
  experiment.programs["swim"] = test::abp(0.04, 0.2, 3);
  experiment.light_table.bands = {{0, 1, "swim"}};
  for (int id = 1; id <= kRobots; ++id) {
    RobotSpec robot;
    robot.id = id;
    experiment.robots.push_back(robot);
  }
  return experiment;
}

/// The packets of one second, tick by tick, of robots on circles.
std::vector<std::vector<Sent>> second(std::int64_t number) {
  static const program_id_t kSwim = toId(crowd().programs.at("swim"));
  std::vector<std::vector<Sent>> ticks(kTicks);
  for (int tick = 0; tick < kTicks; ++tick) {
    const std::int64_t seq = number * kTicks + tick + 1;
    const std::int64_t utime = kStart + seq * kTick_us;
    robot_status_t status{};
    tracked_frame_t frame{};
    for (int id = 1; id <= kRobots; ++id) {
      const double angle = 0.02 * static_cast<double>(seq) + id;
      robot_state_t robot{};
      robot.robot_id = id;
      robot.utime = utime;
      robot.origin = robot_state_t::SIM;
      robot.program = kSwim;
      robot.program_epoch = 1;
      robot.program_start_utime = kStart;
      status.robots.push_back(robot);
      tracked_pose_t pose{};
      pose.robot_id = id;
      pose.x = 0.6 + 0.1 * std::sin(angle);
      pose.y = 0.45 - 0.1 * std::cos(angle);
      pose.theta = std::remainder(angle, 2 * 3.14159265358979);
      pose.confidence = 1;
      frame.robots.push_back(pose);
    }
    status.num_robots = frame.num_robots = kRobots;
    frame.frame = seq;
    auto& out = ticks[static_cast<std::size_t>(tick)];
    out.push_back({channels::kRobotStatus, stamped(status, utime, seq)});
    out.push_back({channels::kTrackedFrame, stamped(frame, utime, seq)});
    if (tick % 2 == 0) {
      light_status_t light{};
      light.mix = 1;
      out.push_back({channels::kLightStatus, stamped(light, utime, seq)});
    }
  }
  return ticks;
}

template <class Message>
void decodeOne(const Sent& sent) {
  Message message{};
  benchmark::DoNotOptimize(decode(sent.data, message));
}

void bareDecoding(benchmark::State& state) {
  const auto ticks = second(0);
  for (auto _ : state) {
    for (const auto& tick : ticks) {
      for (const Sent& sent : tick) {
        if (sent.channel == channels::kRobotStatus) decodeOne<robot_status_t>(sent);
        if (sent.channel == channels::kTrackedFrame) decodeOne<tracked_frame_t>(sent);
        if (sent.channel == channels::kLightStatus) decodeOne<light_status_t>(sent);
      }
    }
  }
}
BENCHMARK(bareDecoding)->Unit(benchmark::kMicrosecond);

/// Without an experiment no tracks are stitched; with one, C(l) is computed too.
void packetsToTopics(benchmark::State& state) {
  Hub hub;
  LabView view(hub, "dashboard", 9, [](const auto&, const auto&) { return light::ImageStore{}; });
  if (state.range(0) != 0) view.begin(crowd(), "run");
  std::int64_t number = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const auto ticks = second(number);
    state.ResumeTiming();
    std::int64_t now = kStart + number++ * kTicks * kTick_us;
    for (const auto& tick : ticks) {
      now += kTick_us / 2;
      for (const Sent& sent : tick) view.take({sent.channel, sent.data, now}, now);
      view.publishMoving(now, true);
      now += kTick_us / 2;
      view.publishMoving(now, true);
    }
    view.publishTotals(now, {});
  }
}
BENCHMARK(packetsToTopics)->ArgName("C_l")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace lab::dashboard

BENCHMARK_MAIN();
