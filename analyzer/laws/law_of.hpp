/// From a program to its law: the only place that knows both.
#pragma once

#include <cstdint>
#include <string>

#include "analyzer/laws/law.hpp"
#include "analyzer/laws/program_motion.hpp"
#include "common/programs/program.hpp"

namespace lab::analysis {

/// The law of a program. A program that depends on its surroundings, its battery, its number, or on
/// the time or distance since its start, has one without curves and with the reason
/// (Law::whyNoVerdict), whatever law its file gives. Another one has the closed form that it names,
/// else its own formulas, else one whose reference must be simulated (Law::isSimulated). None for
/// standing; without curves for a law that is not known. Where the steps of the motors shift the
/// speed, the law has the shifted one.
[[nodiscard]] ProgramLaw lawOf(const Program& program, const RobotBody& body);

/// The same for ideal wheels and clocks.
/// @param wheel_base distance between the robot's wheels, m
[[nodiscard]] ProgramLaw lawOf(const Program& program, double wheel_base);

/// What follows from the parameters of a program by its law, for people: "D_r = 0.75 rad^2/s, L_s =
/// 4.04 cm"; empty: nothing does.
[[nodiscard]] std::string coefficientsText(const Program& program, double wheel_base);

/// What the report will compare the motion with, for people: "judged by the exact law", "not
/// judged: the program reads light ...".
[[nodiscard]] std::string referenceText(const Program& program, double wheel_base);

/// That of a program whose definition is not known.
[[nodiscard]] ProgramLaw lawOfUnknown(std::uint32_t hash, const std::string& name,
                                      double wheel_base);

}  // namespace lab::analysis
