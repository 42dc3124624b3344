#include "dashboard/health/health_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <lab/light_status_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/process/version.hpp"
#include "dashboard/health/advice.hpp"
#include "dashboard/health/process_meter.hpp"
#include "tests/dashboard/message_samples.hpp"

namespace lab::dashboard {
namespace {

using testing::HasSubstr;

service_status_t serviceOf(const char* name, std::int64_t instance = 1) {
  service_status_t status{};
  status.sender = name;
  status.instance = instance;
  status.state = service_status_t::READY;
  status.host = "here";
  status.pid = 42;
  status.contract_version = kContractVersion;
  status.start_utime = kNow - 10 * kSecond;
  return status;
}

struct Lab {
  Lab() { run_info.set(experimentForTests(), "run"); }

  std::vector<Advice> advice(std::int64_t now) {
    return adviceOn({.run_info = run_info,
                     .health = health,
                     .robots = robots,
                     .light = light,
                     .light_utime = now,
                     .bus_utime = bus_utime,
                     .ended = ended,
                     .now = now});
  }
  std::string text(std::int64_t now) {
    std::string all;
    for (const Advice& a : advice(now)) all += a.what + "\n";
    return all;
  }
  void everyRobot(std::int64_t now) { robots.take(statusOf({stateOf(3), stateOf(7)}), now); }

  RunInfo run_info;
  HealthView health;
  RobotsView robots{run_info};
  std::optional<light_status_t> light;
  std::int64_t bus_utime = kNow;
  bool ended = false;
};

TEST(HealthView, CountsStreamsWithTheirRatesAndGaps) {
  HealthView dut;
  MessageHeader header;
  header.sender = "sim_svc";
  header.instance = 1;
  std::int64_t now = kNow;
  for (int second = 0; second < 8; ++second) {
    for (int i = 0; i < 50; ++i) {
      now += 20'000;
      header.utime = now;
      ++header.seq;
      if (second == 6 && i == 10) ++header.seq;  // one is lost
      dut.count(channels::kRobotStatus, header, now);
    }
    dut.tick(now);
  }
  const Json json = dut.json(now, "here", {});
  ASSERT_EQ(json["streams"].size(), 1U);
  EXPECT_EQ(json["streams"][0]["rate_Hz"], 50);
  EXPECT_EQ(json["streams"][0]["received"], 400);
  EXPECT_EQ(json["streams"][0]["lost"], 1);
  EXPECT_EQ(dut.streams().begin()->second.new_losses, 1);
}

TEST(HealthView, LimitsTheNumberOfStreams) {
  HealthView dut;
  MessageHeader header;
  header.sender = "x";
  for (int i = 0; i < 1000; ++i) {
    header.instance = i;
    dut.count(channels::kRobotStatus, header, kNow);
  }
  EXPECT_EQ(dut.streams().size(), HealthView::kMaxStreams);
  EXPECT_EQ(dut.counter().streams().size(), HealthView::kMaxStreams);
  EXPECT_EQ(dut.streamsLeftOut(), 600);
}

TEST(HealthView, ReportsServicesWithTheResourcesOfTheirProcesses) {
  HealthView dut;
  dut.take(serviceOf("tracker_svc"), kNow);
  dut.take(serviceOf("tracker_svc", 2), kNow + kSecond);
  dut.take(serviceOf("tracker_svc", 1), kNow + kSecond);  // late
  EXPECT_EQ(dut.pids("here"), std::vector<std::int32_t>{42});
  EXPECT_TRUE(dut.pids("there").empty());
  const Json row = dut.json(kNow + 2 * kSecond, "here", {{42, {12.5, 30}}})["services"][0];
  EXPECT_EQ(row["state"], "ready");
  EXPECT_EQ(row["starts"], 2);
  EXPECT_EQ(row["age_s"], 1);
  EXPECT_EQ(row["uptime_s"], 12);
  EXPECT_EQ(row["cpu_percent"], 12.5);
  EXPECT_EQ(row["memory_MB"], 30);
}

TEST(HealthView, DoesNotListCommandsOfTheTerminalAsServices) {
  HealthView dut;
  service_status_t last_counts = serviceOf("lab_mark");
  last_counts.state = service_status_t::ENDED;
  dut.take(last_counts, kNow);
  EXPECT_TRUE(dut.services().empty());
}

TEST(Advice, IsEmptyForAHealthyLab) {
  Lab lab;
  lab.everyRobot(kNow);
  lab.health.take(serviceOf("sim_svc"), kNow);
  EXPECT_EQ(lab.text(kNow), "");
}

TEST(Advice, SaysThatNoLabIsActive) {
  Lab lab;
  lab.bus_utime = 0;
  EXPECT_THAT(lab.text(kNow), HasSubstr("no lab is active"));
}

TEST(Advice, NamesSilentServicesAndRobots) {
  Lab lab;
  lab.health.take(serviceOf("projector_ctl"), kNow);
  lab.robots.take(statusOf({stateOf(3)}), kNow);
  EXPECT_THAT(lab.text(kNow), HasSubstr("robot 7: no status received"));
  lab.bus_utime = kNow + 4 * kSecond;
  EXPECT_THAT(lab.text(kNow + 4 * kSecond), HasSubstr("no message from projector_ctl on here"));
  EXPECT_THAT(lab.text(kNow + 4 * kSecond), HasSubstr("robot 3: does not respond"));
  EXPECT_THAT(lab.text(kNow + 30 * kSecond), HasSubstr("on the bus for 26 s"));
  lab.ended = true;
  EXPECT_EQ(lab.text(kNow + 30 * kSecond), "") << "silence is normal after the end of a run";
}

TEST(Advice, NamesRobotsWithProblems) {
  Lab lab;
  robot_state_t low = stateOf(3);
  low.battery = 3.3F;
  low.flags = std::int32_t{robot_state_t::FLAG_REJECTED} | robot_state_t::FLAG_LEASE_EXPIRED;
  robot_state_t pack = stateOf(7);
  pack.battery = 6.7F;
  lab.robots.take(statusOf({low, pack}), kNow);
  EXPECT_THAT(lab.text(kNow), HasSubstr("robot 3, 7: battery is low"));
  EXPECT_THAT(lab.text(kNow), HasSubstr("robot 3: rejected its last command"));
  EXPECT_THAT(lab.text(kNow), HasSubstr("robot 3: stopped because its lease expired"));
  lab.robots.take(statusOf({stateOf(7)}, "robot_bridge"), kNow + kSecond / 10);
  const auto advice = lab.advice(kNow + kSecond / 10);
  ASSERT_FALSE(advice.empty());
  EXPECT_THAT(advice.front().what, HasSubstr("robot 7: two services"));
  EXPECT_EQ(advice.front().level, Advice::Level::kError);
}

TEST(Advice, NamesFaultyServicesAndDamagedMessages) {
  Lab lab;
  lab.everyRobot(kNow);
  service_status_t fault = serviceOf("tracker_svc");
  fault.state = service_status_t::FAULT;
  fault.last_error = "no camera";
  lab.health.take(fault, kNow);
  service_status_t old = serviceOf("analyzer");
  old.contract_version = kContractVersion - 1;
  lab.health.take(old, kNow);
  lab.health.countNotUnderstood("LIGHT_STATUS");
  EXPECT_THAT(lab.text(kNow), HasSubstr("tracker_svc on here has a fault: no camera"));
  EXPECT_THAT(lab.text(kNow), HasSubstr("analyzer on here uses message contract"));
  EXPECT_THAT(lab.text(kNow), HasSubstr("1 messages on LIGHT_STATUS"));
}

TEST(Advice, NamesAClockThatIsAhead) {
  Lab lab;
  lab.everyRobot(kNow);
  MessageHeader header;
  header.sender = "tracker_svc";
  header.utime = kNow + 5 * kSecond;
  lab.health.count(channels::kTrackedFrame, header, kNow);
  EXPECT_THAT(lab.text(kNow), HasSubstr("the clock of tracker_svc is 5.0 s ahead"));
  header.utime = kNow;
  lab.health.count(channels::kTrackedFrame, header, kNow);
  EXPECT_EQ(lab.text(kNow), "");
}

TEST(ProcessMeter, GivesTheShareOfACoreSinceThePreviousCall) {
  ProcessTimes times{1.0, 5e6, 100};
  ProcessMeter dut(
      [&times](std::int32_t pid) { return pid == 42 ? std::optional(times) : std::nullopt; });
  EXPECT_TRUE(std::isnan(dut.measure({42, 43}, kNow).at(42).cpu_percent));
  times.cpu = 1.5;
  const auto uses = dut.measure({42, 43}, kNow + 2 * kSecond);
  EXPECT_EQ(uses.size(), 1U);
  EXPECT_DOUBLE_EQ(uses.at(42).cpu_percent, 25);
  EXPECT_DOUBLE_EQ(uses.at(42).memory_MB, 5);
  times.begun = 101;  // another process with the same id
  EXPECT_TRUE(std::isnan(dut.measure({42}, kNow + 3 * kSecond).at(42).cpu_percent));
}

TEST(ProcessMeter, ReadsThisProcess) {
  const auto own = readProcess(getpid());
  ASSERT_TRUE(own);
  EXPECT_GT(own->memory, 1e6);
  EXPECT_GT(own->begun, 0);
  EXPECT_FALSE(readProcess(-1));
}

}  // namespace
}  // namespace lab::dashboard
