/// From a program to its law: the only place that knows both.
#pragma once

#include <string>

#include "analyzer/laws/law.hpp"
#include "common/programs/program.hpp"

namespace lab::analysis {

/// The law of a program; none for standing. A program that names no law that is known has one
/// without curves and with the reason (Law::whyNoVerdict).
/// @param wheel_base distance between the robot's wheels, m
[[nodiscard]] ProgramLaw lawOf(const Program& program, double wheel_base);

/// What follows from the parameters of a program by its law, for people: "D_r = 0.75 rad^2/s, L_s =
/// 4.04 cm"; empty: nothing does.
[[nodiscard]] std::string coefficientsText(const Program& program, double wheel_base);

/// That of a program whose definition is not known.
[[nodiscard]] ProgramLaw lawOfUnknown(std::uint32_t hash, const std::string& name,
                                      double wheel_base);

}  // namespace lab::analysis
