#include "common/bus/upgrade/from_version_4.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/upgrade/copied_header.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/files/experiment_error.hpp"
#include "common/programs/shipped_programs.hpp"

namespace lab {
namespace {

/// As an experiment file says it, so that both compile to the same byte code.
std::string text(double si, double factor, const char* unit) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.12g %s", si * factor, unit);
  return buffer.data();
}

/// The shipped program that was a built-in model of version 4, and its parameters.
Program shipped(const lab_v4::program_t& old) {
  const auto speed = [](double si) { return text(si, 100, "cm/s"); };
  const auto time = [](double si) { return text(si, 1, "s"); };
  switch (old.kind) {
    case lab_v4::program_t::ABP:
      return shippedProgram(
          "abp",
          {{"v", speed(old.v)}, {"epsilon", time(old.epsilon)}, {"eta", text(old.eta, 1, "rad/s")}},
          kWidestWheels);
    case lab_v4::program_t::NOISY_ABP:
      return shippedProgram(
          "noisy_abp", {{"va", speed(old.va)}, {"V", speed(old.V)}, {"epsilon", time(old.epsilon)}},
          kWidestWheels);
    case lab_v4::program_t::BP:
      return shippedProgram("bp", {{"V", speed(old.V)}, {"epsilon", time(old.epsilon)}},
                            kWidestWheels);
    case lab_v4::program_t::RTP:
      return shippedProgram(
          "rtp",
          {{"v", speed(old.v)}, {"gamma", text(old.gamma, 1, "1/s")}, {"tau_t", time(old.tau_t)}},
          kWidestWheels);
    case lab_v4::program_t::WHEELS:
      return shippedProgram("wheels",
                            {{"left", speed(old.wheel_left)}, {"right", speed(old.wheel_right)}},
                            kWidestWheels);
    case lab_v4::program_t::NONE:
      return {};
    default:
      throw ExperimentError({"version 4 had no program of kind " + std::to_string(old.kind)});
  }
}

/// Whether two programs have the same bits: nan must be found again, too.
bool equal(const lab_v4::program_t& a, const lab_v4::program_t& b) {
  const auto bits = [](const lab_v4::program_t& p) {
    return std::array{
        std::bit_cast<std::uint64_t>(p.v),          std::bit_cast<std::uint64_t>(p.va),
        std::bit_cast<std::uint64_t>(p.V),          std::bit_cast<std::uint64_t>(p.epsilon),
        std::bit_cast<std::uint64_t>(p.eta),        std::bit_cast<std::uint64_t>(p.gamma),
        std::bit_cast<std::uint64_t>(p.tau_t),      std::bit_cast<std::uint64_t>(p.wheel_left),
        std::bit_cast<std::uint64_t>(p.wheel_right)};
  };
  return a.kind == b.kind && bits(a) == bits(b);
}

/// A program that no robot can run gets an impossible hash, so that its message is refused with a
/// reason.
program_t compiled(const lab_v4::program_t& old) {
  try {
    return toMessage(shipped(old));
  } catch (const ExperimentError&) {
    program_t message{};
    message.id.hash = kImpossibleHash;
    message.id.name = "impossible program";
    return message;
  }
}

/// The same few programs come with every message.
const program_t& convert(const lab_v4::program_t& old) {
  constexpr std::size_t kKept = 64;
  thread_local std::vector<std::pair<lab_v4::program_t, program_t>> kept;
  const auto found =
      std::ranges::find_if(kept, [&](const auto& entry) { return equal(entry.first, old); });
  if (found != kept.end()) return found->second;
  if (kept.size() == kKept) kept.erase(kept.begin());
  return kept.emplace_back(old, compiled(old)).second;
}

light_band_t convert(const lab_v4::light_band_t& old) {
  light_band_t message{};
  message.low = old.low;
  message.high = old.high;
  message.program = convert(old.program);
  return message;
}

curve_t convert(const lab_v4::curve_t& old) {
  curve_t message{};
  message.name = old.name;
  message.unit = old.unit;
  message.num_lags = old.num_lags;
  message.lag = old.lag;
  message.value = old.value;
  message.sigma = old.sigma;
  message.exact = old.exact;
  message.paper = old.paper;
  message.windows = old.windows;
  message.biased = old.biased;
  return message;
}

estimate_t convert(const lab_v4::estimate_t& old) {
  estimate_t message{};
  message.name = old.name;
  message.unit = old.unit;
  message.value = old.value;
  message.sigma = old.sigma;
  message.low = old.low;
  message.high = old.high;
  message.theory = old.theory;
  message.note = old.note;
  return message;
}

robot_state_t convert(const lab_v4::robot_state_t& old) {
  robot_state_t message{};
  message.utime = old.utime;
  message.robot_id = old.robot_id;
  message.origin = old.origin;
  message.uid = old.uid;
  message.program = convert(old.program).id;
  message.phase = (old.flags & lab_v4::robot_state_t::FLAG_TUMBLING) != 0 ? 1 : 0;
  message.band = old.band;
  message.program_epoch = old.program_epoch;
  message.program_start_utime = old.program_start_utime;
  message.wheel_left = old.wheel_left;
  message.wheel_right = old.wheel_right;
  message.program_left = old.program_left;
  message.program_right = old.program_right;
  message.light_front = old.light_front;
  message.light_back = old.light_back;
  for (int i = 0; i < 6; ++i) message.ir[i] = old.ir[i];
  message.flags = old.flags;
  message.command_seq = old.command_seq;
  message.command_instance = old.command_instance;
  message.stop_seq = old.stop_seq;
  message.reversal_count = old.reversal_count;
  message.reversal_start_utime = old.reversal_start_utime;
  message.reversal_end_utime = old.reversal_end_utime;
  message.tumble_count = old.tumble_count;
  message.run_time = old.run_time;
  message.battery = old.battery;
  message.link_sent = old.link_sent;
  message.link_received = old.link_received;
  message.link_errors = old.link_errors;
  return message;
}

robot_step_t convert(const lab_v4::robot_step_t& old) {
  robot_step_t message{};
  message.utime = old.utime;
  message.robot_id = old.robot_id;
  message.draw_count = old.draw_count;
  message.program_epoch = old.program_epoch;
  message.slot = old.slot;
  message.wheel_left = old.wheel_left;
  message.wheel_right = old.wheel_right;
  message.duration = old.duration;
  message.rng = old.rng;
  return message;
}

true_pose_t convert(const lab_v4::true_pose_t& old) {
  true_pose_t message{};
  message.robot_id = old.robot_id;
  message.x = old.x;
  message.y = old.y;
  message.theta = old.theta;
  // The number of a kind is not that of a program.
  message.program = old.program == lab_v4::program_t::NONE ? 0 : -1;
  message.contact_robot = old.contact_robot;
  message.contact_wall = old.contact_wall;
  return message;
}

robot_order_t convert(const lab_v4::robot_order_t& old);

template <class New, class Old>
std::vector<New> convertAll(const std::vector<Old>& old) {
  std::vector<New> all;
  all.reserve(old.size());
  for (const Old& one : old) all.push_back(convert(one));
  return all;
}

robot_order_t convert(const lab_v4::robot_order_t& old) {
  robot_order_t message{};
  message.num_robots = old.num_robots;
  message.robot_ids = old.robot_ids;
  message.mode = old.mode;
  message.wheel_left = old.wheel_left;
  message.wheel_right = old.wheel_right;
  message.light_sensor = old.light_sensor;
  message.hysteresis = old.hysteresis;
  message.num_bands = old.num_bands;
  message.bands = convertAll<light_band_t>(old.bands);
  message.reverse_on = old.reverse_on;
  message.reverse_distance = old.reverse_distance;
  message.reverse_speed = old.reverse_speed;
  return message;
}

}  // namespace

robot_command_t convert(const lab_v4::robot_command_t& old) {
  auto message = withHeaderOf<robot_command_t>(old);
  message.lease_ms = old.lease_ms;
  message.num_orders = old.num_orders;
  message.orders = convertAll<robot_order_t>(old.orders);
  return message;
}

robot_status_t convert(const lab_v4::robot_status_t& old) {
  auto message = withHeaderOf<robot_status_t>(old);
  message.num_robots = old.num_robots;
  message.robots = convertAll<robot_state_t>(old.robots);
  return message;
}

robot_steps_t convert(const lab_v4::robot_steps_t& old) {
  auto message = withHeaderOf<robot_steps_t>(old);
  message.num_steps = old.num_steps;
  message.steps = convertAll<robot_step_t>(old.steps);
  return message;
}

sim_truth_t convert(const lab_v4::sim_truth_t& old) {
  auto message = withHeaderOf<sim_truth_t>(old);
  message.collisions = old.collisions;
  message.num_robots = old.num_robots;
  message.robots = convertAll<true_pose_t>(old.robots);
  return message;
}

analysis_t convert(const lab_v4::analysis_t& old) {
  analysis_t message{};
  message.utime = old.utime;
  message.sender = old.sender;
  message.instance = old.instance;
  message.seq = old.seq;
  message.robot_id = old.robot_id;
  message.program = convert(old.program).id;
  message.program.name = old.program_name;
  message.observed = old.observed;
  message.segments = old.segments;
  message.reversals = old.reversals;
  message.contact_share = old.contact_share;
  message.verdict = old.verdict;
  message.max_z = old.max_z;
  message.num_curves = old.num_curves;
  message.curves = convertAll<curve_t>(old.curves);
  message.num_estimates = old.num_estimates;
  message.estimates = convertAll<estimate_t>(old.estimates);
  return message;
}

}  // namespace lab
