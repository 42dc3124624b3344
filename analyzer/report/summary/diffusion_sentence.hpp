#pragma once

#include <string>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// One sentence for the terminal: the long-time diffusion coefficient D of each program with its
/// standard error, beside that of the exact law, as in "diffusion of 6 robots, measured ±
/// standard error: fast: D = 5.1 ± 0.9 cm²/s (law: 6)". D is the exact law's at the measured
/// parameters. Empty where no program has a measured D with an error.
[[nodiscard]] std::string diffusionSentence(const RunRecord& record);

}  // namespace lab::report
