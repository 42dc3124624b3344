/// How a campaign is played on a real lab. Pure data and functions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lab::runner::campaign {

/// "D_r_rad2_s=2%": the mean of a point is known well enough.
struct KnownRule {
  std::string quantity;  ///< of campaign.csv, with or without the name of the program
  double relative = 0;   ///< largest standard error, as a share of the mean

  bool operator==(const KnownRule&) const = default;
};

/// What a live campaign does beside its runs.
struct LivePlan {
  bool rehearsal = false;     ///< in virtual time, on no lab
  double rest_s = 0;          ///< robots stand between two runs [s]
  std::string clear{};        ///< experiment file that is played before each run; empty: none
  std::int64_t tries = 3;     ///< of a run, until it is given up
  std::int64_t strikes = 2;   ///< runs in a row with a problem of a robot, until it is left out
  std::int64_t until_us = 0;  ///< UTC [us] no run ends later; 0: no limit
  std::vector<KnownRule> known{};  ///< all of them end the runs of a point

  bool operator==(const LivePlan&) const = default;
};

/// @param text of the command line: "D_r_rad2_s=2%"
/// @throws UserError
[[nodiscard]] KnownRule parseKnownRule(const std::string& text);

/// The inverse of parseKnownRule().
[[nodiscard]] std::string knownRuleText(const KnownRule& rule);

/// A time of the day ("07:30", the next one in local time) or a date ("2026-01-31T07:30").
/// @param now_us UTC [us]
/// @return UTC [us]
/// @throws UserError also for a time that is past
[[nodiscard]] std::int64_t parseUntil(const std::string& text, std::int64_t now_us);

}  // namespace lab::runner::campaign
