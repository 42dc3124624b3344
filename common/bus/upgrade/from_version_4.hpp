/// Converts the messages that contract version 5 changed. The built-in models of version 4 become
/// the shipped programs of the same names.
#pragma once

#include <lab/analysis_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab_v4/analysis_t.hpp>
#include <lab_v4/robot_command_t.hpp>
#include <lab_v4/robot_status_t.hpp>
#include <lab_v4/robot_steps_t.hpp>
#include <lab_v4/sim_truth_t.hpp>

namespace lab {

[[nodiscard]] analysis_t convert(const lab_v4::analysis_t& old);
[[nodiscard]] robot_command_t convert(const lab_v4::robot_command_t& old);
[[nodiscard]] robot_status_t convert(const lab_v4::robot_status_t& old);
[[nodiscard]] robot_steps_t convert(const lab_v4::robot_steps_t& old);
[[nodiscard]] sim_truth_t convert(const lab_v4::sim_truth_t& old);

}  // namespace lab
