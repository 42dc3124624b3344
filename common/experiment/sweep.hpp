/// The table [sweep] of an experiment file: the campaign that `lab sweep` makes of it
/// (docs/campaigns.md). A single run does not know it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

/// How points are drawn.
enum class Sampling : std::int8_t {
  kLatin,  ///< a Latin hypercube
  kSobol,  ///< Sobol's sequence
};

struct SweepTable {
  std::vector<std::string> over;  ///< as after --over: "programs.NAME.eta_rad_s=1,2,3"
  bool zip = false;               ///< values of the same number belong together
  std::int64_t seeds = 1;         ///< runs per point
  std::int64_t random = 0;        ///< number of points that are drawn; 0: all combinations
  Sampling sampling = Sampling::kLatin;

  bool operator==(const SweepTable&) const = default;
};

/// The table of an experiment's text; the defaults without one.
/// @param name of the text, for messages
/// @throws ExperimentError for wrong values in the table; other problems of the file are not
///   reported here
[[nodiscard]] SweepTable readSweepTable(std::string_view text, const std::string& name);

}  // namespace lab
