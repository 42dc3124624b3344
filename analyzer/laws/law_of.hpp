/// From a program to its law: the only place that knows both.
#pragma once

#include "analyzer/laws/law.hpp"
#include "common/programs/law_text.hpp"
#include "robot/dynamics/robot_program.hpp"

namespace lab::analysis {

/// The law of a program; none for standing and constant wheel speeds.
/// @param wheel_base distance between the robot's wheels, m
[[nodiscard]] ProgramLaw lawOf(const dynamics::RobotProgram& program, double wheel_base);

/// The closed form that a program names; none if it names none.
/// @throws std::invalid_argument as closedForm()
[[nodiscard]] ProgramLaw lawOf(const LawText& text, double wheel_base);

}  // namespace lab::analysis
