/// A campaign as plain data: what was asked, its points, and its rows. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/sweep.hpp"
#include "runner/campaign/axis.hpp"
#include "runner/campaign/design.hpp"
#include "runner/campaign/live/live_plan.hpp"

namespace lab::runner::campaign {

/// What a campaign keeps of each run, besides its row in the table.
enum class Keep : std::int8_t {
  kLogs,     ///< its folder as of `lab run`: log, summary, report, figures
  kSummary,  ///< summary.json, with the curves
  kNothing,
};

[[nodiscard]] const char* nameOf(Keep keep);

/// What was asked: file and options, with the table [sweep] filled in.
struct Request {
  std::string name;               ///< of the experiment
  std::string file;               ///< absolute path of the experiment file
  std::vector<std::string> set;   ///< key=value, for every run
  std::vector<std::string> over;  ///< as after --over
  bool zip = false;
  std::int64_t seeds = 1;
  std::int64_t random = 0;
  Sampling sampling = Sampling::kLatin;
  std::uint64_t seed = 1;     ///< the base of all seeds
  bool common_seeds = false;  ///< all points share their random numbers
  Keep keep = Keep::kSummary;
  bool fits = false;                       ///< also fits the exact laws, by simulated recordings
  std::optional<LivePlan> live{};          ///< played on a real lab; empty: simulated
  std::optional<AdaptivePlan> adaptive{};  ///< which runs are made; empty: all

  bool operator==(const Request&) const = default;

  [[nodiscard]] Design design() const;
};

/// Whether its runs drive the robots of this machine; a rehearsal does not.
[[nodiscard]] bool isOnRealLab(const Request& request);

/// The text of campaign.toml. readRequest() gives an equal request.
/// @param created "2026-01-31T12:00:00Z"
[[nodiscard]] std::string requestText(const Request& request, const std::string& created);

/// @param name of the text, for messages
/// @throws ExperimentError
[[nodiscard]] Request readRequest(std::string_view text, const std::string& name);

/// One point: the experiment that all its runs have, but for their seeds.
struct Point {
  PointValues values;
  std::string experiment;  ///< the effective file with seed = 0; files are named by their SHA-256
  std::string hash;        ///< SHA-256 of `experiment`
  double duration = 0;     ///< [s] of a run
};

[[nodiscard]] Point makePoint(PointValues values, std::string experiment, double duration);

/// All rows are in memory. Without its result a row costs 25 us and 0.3 kB, and ten times as much
/// if the tables are made.
inline constexpr std::int64_t kMostRows = 1'000'000;

/// @param where the file that asks for the rows, for messages
/// @throws UserError if a campaign of so many points has too many rows
void requireFewRows(const Request& request, std::size_t points, const std::string& where);

/// What of this software decides the bytes of a run.
struct CodeVersion {
  std::string text;  ///< "0.1.0 (2f3c1a9e8b7d)"
  int contract = 0;
};

/// Identifies a run by all that decides its bytes.
struct RunIdentity {
  std::string recipe;  ///< hash of experiment, seed and kind of analysis, 16 hexadecimal digits
  std::string code;    ///< hash of the code version, 8 digits

  bool operator==(const RunIdentity&) const = default;
  [[nodiscard]] std::string text() const { return recipe + "-" + code; }
};

/// One run of the campaign.
struct Row {
  std::size_t point = 0;       ///< index into the points
  std::int64_t replicate = 0;  ///< number of the run at its point, from 0
  std::uint64_t seed = 0;
  RunIdentity identity;
};

/// The rows, in the order in which they are run: the first run of every point, then the second ...
/// A row's number is its index. More seeds, or more values, leave the identities of the others
/// unchanged. Runs of a real lab are measurements: the version of the code is not part of their
/// identity.
[[nodiscard]] std::vector<Row> rowsOf(const Request& request, const std::vector<Point>& points,
                                      const CodeVersion& code);

/// The seed of a run: a function of the campaign's seed, the number of the run at its point, and
/// the point's experiment. So points have independent random numbers. With common seeds, runs of
/// the same number have the same seed at every point.
[[nodiscard]] std::uint64_t seedOf(const Request& request, const Point& point,
                                   std::int64_t replicate);

/// "0-3,7": numbers of rows, from a command line.
/// @param count the number of rows of the campaign
/// @throws UserError
[[nodiscard]] std::vector<std::size_t> parseRowNumbers(const std::string& text, std::size_t count);

/// The inverse of parseRowNumbers(). @param numbers rising
[[nodiscard]] std::string rowNumbersText(const std::vector<std::size_t>& numbers);

/// SHA-256 of a text in 64 hexadecimal digits.
[[nodiscard]] std::string sha256Of(std::string_view text);

}  // namespace lab::runner::campaign
