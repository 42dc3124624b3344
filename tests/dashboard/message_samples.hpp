/// Sample messages and a sample experiment for the tests of the dashboard.
#pragma once

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/experiment_event_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/program_messages.hpp"

namespace lab::dashboard {

using Json = nlohmann::ordered_json;

inline constexpr std::int64_t kNow = 1'700'000'000'000'000;  // [us since 1970]
inline constexpr std::int64_t kSecond = 1'000'000;

inline Experiment experimentForTests() {
  return parseExperiment(R"(
fileversion = 1
name = "two_programs"
duration_s = 60

[[robots]]
id = 3
[[robots]]
id = 7

[programs.swim]
model = "abp"
v_cm_s = 4
epsilon_s = 0.2
eta_rad_s = 3
[programs.tumble]
model = "rtp"
v_cm_s = 4
gamma_per_s = 0.5
tau_t_s = 0.5

[light_table]
bands = [
  {light = [0.0, 0.45], program = "swim"},
  {light = [0.55, 1.0], program = "tumble"},
]

[[light.steps]]
at_s = 0
layers = [{kind = "uniform", intensity = 0.2}]
)",
                         "two_programs");
}

inline robot_state_t stateOf(std::int32_t id, const program_id_t& program = {}) {
  robot_state_t state{};
  state.robot_id = id;
  state.origin = robot_state_t::SIM;
  state.utime = kNow;
  state.program = program;
  state.battery = 4.1F;
  return state;
}

inline robot_status_t statusOf(std::vector<robot_state_t> states, const char* sender = "sim_svc") {
  robot_status_t status{};
  status.utime = kNow;
  status.sender = sender;
  status.instance = 1;
  status.robots = std::move(states);
  status.num_robots = static_cast<std::int32_t>(status.robots.size());
  return status;
}

inline tracked_pose_t poseOf(std::int32_t id, double x, double y, double theta = 0) {
  tracked_pose_t pose{};
  pose.robot_id = id;
  pose.x = x;
  pose.y = y;
  pose.theta = theta;
  pose.covariance[0] = pose.covariance[3] = 1e-6;  // 1 mm
  pose.confidence = 1;
  return pose;
}

inline tracked_frame_t frameOf(std::int64_t utime, std::vector<tracked_pose_t> poses) {
  tracked_frame_t frame{};
  frame.utime = utime;
  frame.sender = "sim_svc";
  frame.instance = 1;
  frame.origin = robot_state_t::SIM;
  frame.frame = utime / 20'000;
  frame.frame_period = 0.02;
  frame.robots = std::move(poses);
  frame.num_robots = static_cast<std::int32_t>(frame.robots.size());
  return frame;
}

inline analysis_t poolOf(const std::string& program, std::int64_t utime) {
  analysis_t analysis{};
  analysis.utime = utime;
  analysis.sender = "analyzer";
  analysis.instance = 1;
  analysis.robot_id = analysis_t::POOL;
  analysis.program = toId(experimentForTests().programs.at(program));
  analysis.observed = 12.5;
  analysis.verdict = analysis_t::AGREES;
  analysis.max_z = 1.5;
  curve_t msd{};
  msd.name = "msd";
  msd.unit = "m^2";
  msd.lag = {1, 2};
  msd.value = {0.01F, 0.02F};
  msd.sigma = {0.001F, 0.002F};
  msd.exact = {0.011F, 0.021F};
  msd.paper = {0.012F, 0.022F};
  msd.windows = {10, 5};
  msd.biased = {0, 1};
  msd.num_lags = 2;
  analysis.curves = {msd};
  analysis.num_curves = 1;
  estimate_t v{};
  v.name = "v";
  v.unit = "m/s";
  v.value = 0.04;
  v.sigma = 0.001;
  v.low = 0.038;
  v.high = 0.042;
  v.theory = std::numeric_limits<double>::quiet_NaN();
  v.note = "by \"speed\"";
  analysis.estimates = {v};
  analysis.num_estimates = 1;
  return analysis;
}

}  // namespace lab::dashboard
