/// The result of one run of a campaign: its row of numbers. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "runner/campaign/campaign.hpp"

namespace lab::runner::campaign {

/// One cell of the table: nothing, a number, or a text.
using Cell = std::variant<std::monostate, double, std::string>;

/// Named cells in the order of the summary.
using Columns = std::vector<std::pair<std::string, Cell>>;

struct RunResult {
  RunIdentity identity;
  std::string code;  ///< CodeVersion::text
  std::uint64_t seed = 0;
  bool closed_early = false;  ///< a condition of the script or of stop_when was not met in time
  std::vector<std::string> faults;
  Columns columns;
};

/// The text of a result's file: JSON with a checksum. It depends on nothing but the run.
[[nodiscard]] std::string resultText(const RunResult& result);

/// A result, or why there is none.
struct ReadResult {
  std::variant<RunResult, std::string> result;

  [[nodiscard]] const RunResult* get() const { return std::get_if<RunResult>(&result); }
  [[nodiscard]] const std::string& problem() const { return std::get<std::string>(result); }
};

/// @param expected the run that the file must be of
[[nodiscard]] ReadResult readResult(std::string_view text, const RunIdentity& expected);

/// All numbers of a summary.json, and the verdicts. The pool of a program has the name of the
/// program before its columns, and each estimate the columns X, X.standard_error, X.low95 ... :
/// "NAME.D_r_rad2_s". Curves, lists and the numbers of single robots are left out. Sections that
/// this program does not know are taken with their path as name.
/// @throws std::runtime_error if it is no summary.json
[[nodiscard]] Columns columnsOf(std::string_view summary_json);

}  // namespace lab::runner::campaign
