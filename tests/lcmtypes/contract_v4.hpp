/// The types that contract version 5 changed and logs of version 4 still hold, as contract.hpp has
/// those of today.
#pragma once

#include <lab_v4/analysis_t.hpp>
#include <lab_v4/curve_t.hpp>
#include <lab_v4/estimate_t.hpp>
#include <lab_v4/light_band_t.hpp>
#include <lab_v4/program_t.hpp>
#include <lab_v4/robot_command_t.hpp>
#include <lab_v4/robot_order_t.hpp>
#include <lab_v4/robot_state_t.hpp>
#include <lab_v4/robot_status_t.hpp>
#include <lab_v4/robot_step_t.hpp>
#include <lab_v4/robot_steps_t.hpp>
#include <lab_v4/sim_truth_t.hpp>
#include <lab_v4/true_pose_t.hpp>
#include <tuple>

#include "tests/lcmtypes/contract.hpp"

namespace lab_v4 {

using AllTypes = lab::TypeList<analysis_t, curve_t, estimate_t, light_band_t, program_t,
                               robot_command_t, robot_order_t, robot_state_t, robot_status_t,
                               robot_step_t, robot_steps_t, sim_truth_t, true_pose_t>;

inline auto fields(program_t& m) {
  return std::tie(m.kind, m.v, m.va, m.V, m.epsilon, m.eta, m.gamma, m.tau_t, m.wheel_left,
                  m.wheel_right);
}
inline auto fields(light_band_t& m) { return std::tie(m.low, m.high, m.program); }
inline auto fields(robot_order_t& m) {
  return std::tie(m.num_robots, m.robot_ids, m.mode, m.wheel_left, m.wheel_right, m.light_sensor,
                  m.hysteresis, m.num_bands, m.bands, m.reverse_on, m.reverse_distance,
                  m.reverse_speed);
}
inline auto fields(robot_state_t& m) {
  return std::tie(m.utime, m.robot_id, m.origin, m.uid, m.program, m.band, m.program_epoch,
                  m.program_start_utime, m.wheel_left, m.wheel_right, m.program_left,
                  m.program_right, m.light_front, m.light_back, m.ir, m.flags, m.command_seq,
                  m.command_instance, m.stop_seq, m.reversal_count, m.reversal_start_utime,
                  m.reversal_end_utime, m.tumble_count, m.run_time, m.battery, m.link_sent,
                  m.link_received, m.link_errors);
}
inline auto fields(robot_step_t& m) {
  return std::tie(m.utime, m.robot_id, m.draw_count, m.program_epoch, m.slot, m.kind, m.wheel_left,
                  m.wheel_right, m.duration, m.rng);
}
inline auto fields(true_pose_t& m) {
  return std::tie(m.robot_id, m.x, m.y, m.theta, m.program, m.contact_robot, m.contact_wall);
}
inline auto fields(curve_t& m) {
  return std::tie(m.name, m.unit, m.num_lags, m.lag, m.value, m.sigma, m.exact, m.paper, m.windows,
                  m.biased);
}
inline auto fields(estimate_t& m) {
  return std::tie(m.name, m.unit, m.value, m.sigma, m.low, m.high, m.theory, m.note);
}
inline auto fields(analysis_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.robot_id, m.program, m.program_name,
                  m.observed, m.segments, m.reversals, m.contact_share, m.verdict, m.max_z,
                  m.num_curves, m.curves, m.num_estimates, m.estimates);
}
inline auto fields(robot_command_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.lease_ms, m.num_orders, m.orders);
}
inline auto fields(robot_status_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.num_robots, m.robots);
}
inline auto fields(robot_steps_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.num_steps, m.steps);
}
inline auto fields(sim_truth_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.collisions, m.num_robots, m.robots);
}

}  // namespace lab_v4
