#pragma once

#include <string>

#include "robot/language/dimension.hpp"

namespace lab::analysis {

/// The dimension of an SI unit as ProgramParameter and LawParameter have it: "m^2/s", "rad/s", "1".
[[nodiscard]] language::Dimension dimensionOf(const std::string& unit);

}  // namespace lab::analysis
