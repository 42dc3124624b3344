/// The laws of programs that name no closed form: their own formulas, or simulated films.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analyzer/laws/program_motion.hpp"
#include "common/programs/program.hpp"

namespace lab::analysis {

/// A law without curves.
/// @param reason why the motion cannot be judged, a sentence
[[nodiscard]] std::shared_ptr<const Law> makeNoLaw(const Program& program, double wheel_base,
                                                   const std::string& reason);

/// The law of a program's own formulas; at least one of the MSD and the angular MSD is given.
/// @throws language::SyntaxError for a wrong formula
[[nodiscard]] std::shared_ptr<const Law> makeFormulaLaw(const Program& program,
                                                        const RobotBody& body);

/// A law that is known by simulated films only.
[[nodiscard]] std::shared_ptr<const Law> makeSimulatedLaw(const Program& program,
                                                          const RobotBody& body);

}  // namespace lab::analysis
