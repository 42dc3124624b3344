/// The table [sweep] of an experiment file: the campaign that `lab sweep` makes of it
/// (docs/campaigns.md). A single run does not know it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

/// How points are drawn.
enum class Sampling : std::int8_t {
  kLatin,  ///< a Latin hypercube
  kSobol,  ///< Sobol's sequence
};

/// What an adaptive campaign shall know as well as possible.
enum class AdaptiveGoal : std::int8_t {
  kMean,      ///< a quantity at all points, without a law
  kLaw,       ///< parameters of its power law in the swept keys
  kBoundary,  ///< where it crosses a level along the first swept key
};

/// The table [sweep.adaptive]: which runs `lab sweep --adaptive` makes, of those of the grid.
struct AdaptivePlan {
  AdaptiveGoal goal = AdaptiveGoal::kMean;
  std::string quantity{};   ///< column of campaign.csv, with or without the program's name
  std::string parameter{};  ///< of a law; empty: the default
  bool relative = false;    ///< of a mean: relative errors count, not absolute ones
  double level = 0;         ///< of a boundary, in the unit of the quantity
  double robot_time_s = 0;  ///< [s] of all runs, at most; 0: no limit
  double error = 0;         ///< the campaign ends at this standard error; 0: no such rule
  std::int64_t runs_per_round = 4;
  double between_runs_s = 0;  ///< [s] robot time that a run takes beside its duration

  bool operator==(const AdaptivePlan&) const = default;
};

struct SweepTable {
  std::vector<std::string> over;  ///< as after --over: "programs.NAME.eta_rad_s=1,2,3"
  bool zip = false;               ///< values of the same number belong together
  std::int64_t seeds = 1;         ///< runs per point
  std::int64_t random = 0;        ///< number of points that are drawn; 0: all combinations
  Sampling sampling = Sampling::kLatin;
  std::optional<AdaptivePlan> adaptive{};  ///< used with `lab sweep --adaptive`

  bool operator==(const SweepTable&) const = default;
};

/// The table of an experiment's text; the defaults without one.
/// @param name of the text, for messages
/// @param set settings as after --set, of which those of the table are applied
/// @throws ExperimentError for wrong values in the table; other problems of the file are not
///   reported here
[[nodiscard]] SweepTable readSweepTable(std::string_view text, const std::string& name,
                                        const std::vector<std::string>& set = {});

}  // namespace lab
