#include "common/bus/message_values.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/light_seen_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/program_messages.hpp"
#include "common/math/saturated.hpp"

namespace lab::message_values_test {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kInfinityF = std::numeric_limits<float>::infinity();
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

robot_status_t status() {
  robot_status_t status{};
  status.utime = kNow;
  status.robots.resize(3);
  status.num_robots = 3;
  for (robot_state_t& state : status.robots) {
    state.utime = kNow;
    state.program.hash = 0xFFFF'FFFF;
    state.program.name = "abp";
    state.phase = 7;
  }
  return status;
}

template <class Message>
std::string problem(const Message& message) {
  return impossibleValue(message).value_or("");
}

TEST(MessageValues, NameFieldFoundAndExpected) {
  tracked_frame_t frame{};
  frame.utime = kNow;
  frame.robots.resize(2);
  EXPECT_EQ(problem(frame), "");
  frame.robots[1].x = 1e300;
  EXPECT_EQ(problem(frame), "robots[1].x: found 1e+300, expected -1000 to 1000");
  frame.robots[1].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(problem(frame), "robots[1].x: found nan, expected -1000 to 1000");
  frame.robots[1].x = 0;
  frame.utime = -1;
  EXPECT_EQ(problem(frame), "utime: found -1, expected 0 to 4102444800000000");
}

TEST(MessageValues, ANumberJustBeyondABoundDoesNotLookLikeTheBound) {
  tracked_frame_t frame{};
  frame.utime = kNow;
  frame.robots.resize(1);
  frame.robots[0].x = 1000.0000001;
  EXPECT_EQ(problem(frame), "robots[0].x: found 1000.0000001, expected -1000 to 1000");
  frame.robots[0].x = std::nextafter(1000.0, 2000.0);
  EXPECT_EQ(problem(frame), "robots[0].x: found 1000.0000000000001, expected -1000 to 1000");
  frame.robots[0].x = 1234.5678;
  EXPECT_EQ(problem(frame), "robots[0].x: found 1234.57, expected -1000 to 1000");
}

TEST(MessageValues, RefuseHashesAndPhasesThatNoProgramHas) {
  EXPECT_EQ(problem(status()), "");
  robot_status_t dut = status();
  dut.robots[2].program.hash = kImpossibleHash;
  EXPECT_EQ(problem(dut), "robots[2].program.hash: found -1, expected 0 to 4294967295");
  dut.robots[2].program.hash = 0x1'0000'0000;
  EXPECT_EQ(problem(dut), "robots[2].program.hash: found 4294967296, expected 0 to 4294967295");
  dut = status();
  dut.robots[2].phase = -1;
  EXPECT_EQ(problem(dut), "robots[2].phase: found -1, expected 0 to 127");
}

/// Results with all that is not known yet: intervals of little data are open.
analysis_t analysis() {
  analysis_t analysis{};
  analysis.utime = kNow;
  analysis.robot_id = analysis_t::POOL;
  analysis.verdict = analysis_t::DISAGREES;
  analysis.max_z = 5.5;
  analysis.contact_share = 1;
  curve_t curve{};
  curve.lag = {0.02F, 100};
  curve.value = {0, 2};
  curve.sigma = {0.1F, kNanF};
  curve.exact = {-0.03F, 2};  // less the noise
  curve.paper = {kNanF, kNanF};
  curve.windows = {1, std::numeric_limits<std::int32_t>::max()};
  curve.biased = {0, 1};
  curve.num_lags = 2;
  analysis.curves = {curve};
  analysis.num_curves = 1;
  estimate_t rate{};
  rate.name = "D_r";
  rate.value = 0.5;
  rate.sigma = 0.1;
  rate.low = -kInfinity;
  rate.high = kInfinity;
  rate.theory = kNan;
  estimate_t length{};
  length.name = "L_s";
  length.value = length.low = length.high = length.theory = kInfinity;
  analysis.estimates = {rate, length};
  analysis.num_estimates = 2;
  return analysis;
}

collective_t crowd() {
  collective_t crowd{};
  crowd.utime = kNow;
  crowd.observed = 60;
  crowd.robots = 19.5;
  observable_t order{};
  order.name = "polar_order";
  order.now = 0.5;
  order.mean = -0.25;
  order.sigma = 0.01;
  order.low = order.high = kNan;
  observable_t time = order;
  time.now = time.mean = time.sigma = kNan;
  crowd.observables = {order, time};
  crowd.num_observables = 2;
  observable_curve_t curve{};
  curve.x = {0.08F};
  curve.value = {-1.5F};
  curve.low = curve.high = {kNanF};
  curve.num_points = 1;
  crowd.curves = {curve};
  crowd.num_curves = 1;
  crowd_member_t member{};
  member.robot_id = 7;
  member.cluster = 2;
  member.density = 4e4F;  // robots at the same place
  member.hexatic = kNanF;
  crowd.members = {member};
  crowd.num_members = 1;
  return crowd;
}

/// What was found instead of a finite number.
const std::string kInsteadOfFinite = ": found inf, expected -1.79769e+308 to 1.79769e+308";
const std::string kInsteadOfPositive = ": found inf, expected 0 to 1.79769e+308";

TEST(MessageValues, RefuseInfiniteResults) {
  EXPECT_EQ(problem(analysis()), "");
  analysis_t dut = analysis();
  dut.estimates[0].sigma = kInfinity;
  EXPECT_EQ(problem(dut), "estimates[0].sigma" + kInsteadOfPositive);
  dut = analysis();
  dut.max_z = kInfinity;
  EXPECT_EQ(problem(dut), "max_z" + kInsteadOfPositive);
  dut = analysis();
  dut.observed = kInfinity;
  EXPECT_EQ(problem(dut), "observed" + kInsteadOfPositive);
  for (std::vector<float> curve_t::*column : {&curve_t::value, &curve_t::exact, &curve_t::paper}) {
    dut = analysis();
    (dut.curves[0].*column)[1] = kInfinityF;
    EXPECT_NE(problem(dut).find(kInsteadOfFinite), std::string::npos) << problem(dut);
  }
  dut = analysis();
  dut.curves[0].sigma[1] = kInfinityF;
  EXPECT_EQ(problem(dut), "curves[0].sigma" + kInsteadOfPositive);
  dut = analysis();
  dut.curves[0].lag[0] = kInfinityF;
  EXPECT_EQ(problem(dut), "curves[0].lag: found inf, expected 0 to 1e+10");
}

/// The relative error of such an estimate is 0: it would end steps and runs.
TEST(MessageValues, RefuseAnInfiniteEstimateWithAnError) {
  analysis_t dut = analysis();
  dut.estimates[0].value = -kInfinity;
  EXPECT_EQ(problem(dut), "estimates[0].value: found -inf, expected -1.79769e+308 to 1.79769e+308");
}

TEST(MessageValues, RefuseCountsAndSharesThatNoAnalysisHas) {
  analysis_t dut = analysis();
  dut.robot_id = -2;
  EXPECT_EQ(problem(dut), "robot_id: found -2, expected -1 to 2147483647");
  dut = analysis();
  dut.program.hash = kImpossibleHash;
  EXPECT_EQ(problem(dut), "program.hash: found -1, expected 0 to 4294967295");
  dut = analysis();
  dut.segments = -1;
  EXPECT_EQ(problem(dut), "segments: found -1, expected 0 to 2147483647");
  dut = analysis();
  dut.reversals = -1;
  EXPECT_EQ(problem(dut), "reversals: found -1, expected 0 to 2147483647");
  dut = analysis();
  dut.contact_share = kNan;
  EXPECT_EQ(problem(dut), "contact_share: found nan, expected 0 to 1");
  dut = analysis();
  dut.verdict = 3;
  EXPECT_EQ(problem(dut), "verdict: found 3, expected 0 to 2");
  dut = analysis();
  dut.curves[0].windows[0] = -1;
  EXPECT_EQ(problem(dut), "curves[0].windows: found -1, expected 0 to 2147483647");
  dut = analysis();
  dut.curves[0].biased[0] = 2;
  EXPECT_EQ(problem(dut), "curves[0].biased: found 2, expected 0 to 1");
}

/// They end steps and runs, and set the light.
TEST(MessageValues, RefuseInfiniteNumbersOfACrowd) {
  EXPECT_EQ(problem(crowd()), "");
  for (double observable_t::*number :
       {&observable_t::now, &observable_t::mean, &observable_t::low, &observable_t::high}) {
    collective_t dut = crowd();
    dut.observables[1].*number = kInfinity;
    EXPECT_NE(problem(dut).find(kInsteadOfFinite), std::string::npos) << problem(dut);
  }
  for (std::vector<float> observable_curve_t::*column :
       {&observable_curve_t::value, &observable_curve_t::low, &observable_curve_t::high}) {
    collective_t dut = crowd();
    (dut.curves[0].*column)[0] = kInfinityF;
    EXPECT_NE(problem(dut).find(kInsteadOfFinite), std::string::npos) << problem(dut);
  }
  collective_t dut = crowd();
  dut.observables[0].sigma = kInfinity;
  EXPECT_EQ(problem(dut), "observables[0].sigma" + kInsteadOfPositive);
  dut = crowd();
  dut.members[0].density = kInfinityF;
  EXPECT_EQ(problem(dut), "members[0].density" + kInsteadOfPositive);
  dut = crowd();
  dut.members[0].hexatic = -0.5F;
  EXPECT_EQ(problem(dut), "members[0].hexatic: found -0.5, expected 0 to 1.79769e+308");
  dut = crowd();
  dut.members[0].cluster = -1;
  EXPECT_EQ(problem(dut), "members[0].cluster: found -1, expected 0 to 32767");
  dut = crowd();
  dut.robots = kInfinity;
  EXPECT_EQ(problem(dut), "robots: found inf, expected 0 to 1e+12");
  dut = crowd();
  dut.observed = -1;
  EXPECT_EQ(problem(dut), "observed: found -1, expected 0 to 1.79769e+308");
  dut = crowd();
  dut.program.hash = kImpossibleHash;
  EXPECT_EQ(problem(dut), "program.hash: found -1, expected 0 to 4294967295");
  dut = crowd();
  dut.curves[0].x[0] = kInfinityF;
  EXPECT_EQ(problem(dut), "curves[0].x: found inf, expected -1e+12 to 1e+12");
}

TEST(MessageValues, RefuseReadingsOfThePatchThatNoCameraHas) {
  light_seen_t seen{};
  seen.utime = kNow;
  seen.frame = -1;
  seen.level = -0.13F;
  seen.sync = -1;
  EXPECT_EQ(problem(seen), "");
  seen.sync = 2;
  EXPECT_EQ(problem(seen), "sync: found 2, expected -1 to 1");
  seen.sync = 1;
  seen.frame = -2;
  EXPECT_EQ(problem(seen), "frame: found -2, expected -1 to 1125899906842624");
  seen.frame = 7;
  seen.level = kNanF;
  EXPECT_EQ(problem(seen), "level: found nan, expected -3.40282e+38 to 3.40282e+38");
  seen.level = kInfinityF;
  EXPECT_EQ(problem(seen), "level: found inf, expected -3.40282e+38 to 3.40282e+38");
}

/// The simulator subtracts it from a time in microseconds.
TEST(MessageValues, RefuseATimeOfTheScriptThatDoesNotFitMicroseconds) {
  experiment_status_t status{};
  status.utime = kNow;
  status.step_left = kNan;
  EXPECT_EQ(problem(status), "");
  status.elapsed = 1e300;
  EXPECT_EQ(problem(status), "elapsed: found 1e+300, expected -1e+10 to 1e+10");
}

TEST(MessageValues, NeverRefuseAStop) {
  robot_stop_t stop{};
  stop.utime = std::numeric_limits<std::int64_t>::min();
  stop.seq = -1;
  EXPECT_EQ(problem(stop), "");
  EXPECT_FALSE(impossibleHeader("ROBOT_STOP", stop.utime, stop.seq));
  EXPECT_TRUE(impossibleHeader("ROBOT_COMMAND", stop.utime, stop.seq));
}

TEST(MessageValues, OnlyTheRobotConcernedIsRemoved) {
  robot_status_t dut = status();
  EXPECT_FALSE(removeImpossible(dut));
  dut.robots[0].robot_id = 1;
  dut.robots[1].run_time = -1;
  dut.robots[2].robot_id = 3;
  const auto found = removeImpossible(dut);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->usable);
  EXPECT_EQ(found->count, 1);
  EXPECT_EQ(found->first, "robots[1].run_time: found -1, expected 0 to 1e+10");
  ASSERT_EQ(dut.robots.size(), 2U);
  EXPECT_EQ(dut.num_robots, 2);
  EXPECT_EQ(dut.robots[1].robot_id, 3);
}

TEST(MessageValues, OnlyTheDetectionConcernedIsRemoved) {
  tracked_frame_t frame{};
  frame.utime = kNow;
  frame.robots.resize(2);
  frame.num_robots = 2;
  frame.unidentified.resize(2);
  frame.num_unidentified = 2;
  frame.robots[0].y = 1e9;
  frame.unidentified[1].theta = std::numeric_limits<double>::quiet_NaN();
  const auto found = removeImpossible(frame);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->count, 2);
  EXPECT_EQ(frame.num_robots, 1);
  EXPECT_EQ(frame.num_unidentified, 1);
  EXPECT_EQ(problem(frame), "");
}

TEST(MessageValues, AMessageWithAnImpossibleHeaderIsNotUsable) {
  tracked_frame_t frame{};
  frame.utime = kNow;
  frame.frame = -7;
  frame.robots.resize(1);
  frame.num_robots = 1;
  frame.robots[0].y = 1e9;
  const auto found = removeImpossible(frame);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->usable);
  EXPECT_EQ(found->count, 1);
}

TEST(Saturated, DifferencesDoNotOverflow) {
  constexpr std::int64_t kLowest = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(saturatedDifference(7, 9), -2);
  EXPECT_EQ(saturatedDifference(kLowest, 1), kLowest);
  EXPECT_EQ(saturatedDifference(kHighest, -1), kHighest);
}

TEST(Saturated, SumsDoNotOverflow) {
  constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(limitedSum(2, 3, 10), 5);
  EXPECT_EQ(limitedSum(2, 9, 10), 10);
  EXPECT_EQ(limitedSum(kHighest, kHighest, 10), 10);
}

TEST(Saturated, LimitsWhatACastCannotHold) {
  EXPECT_EQ(saturated<int>(1e300), std::numeric_limits<int>::max());
  EXPECT_EQ(saturated<int>(-1e300), std::numeric_limits<int>::min());
  EXPECT_EQ(saturated<int>(std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_EQ(saturated<std::int64_t>(9.3e18), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(saturated<std::uint8_t>(-3.5), 0);
  EXPECT_EQ(saturated<int>(-3.5), -3);
}

}  // namespace
}  // namespace lab::message_values_test
