/// The tables of a campaign: a row per run, and a row per point. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "runner/campaign/campaign.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/pooling.hpp"

namespace lab::runner::campaign {

/// What the tables and the page are made of.
struct CampaignData {
  Request request;
  std::string created;
  CodeVersion code;
  std::vector<Axis> axes;
  std::vector<Point> points;
  std::vector<Row> rows;
  Survey survey;
};

/// A number that is pooled: a column of the runs without its errors.
struct Quantity {
  std::string name;         ///< of the column: "NAME.D_r_rad2_s"
  bool has_errors = false;  ///< the runs give a standard error
  bool has_theory = false;  ///< and the value of the programmed parameters
};

/// The runs of one point together.
struct PooledPoint {
  int runs = 0;                       ///< with a result
  int stale = 0;                      ///< of these, of another version of the code
  int faults = 0;                     ///< of these, with faults
  std::vector<PooledNumber> numbers;  ///< of each quantity
  std::vector<double> theory;         ///< of each quantity; nan: none
  /// Number of runs by program and verdict: "NAME.verdict" -> "agrees" -> 3.
  std::map<std::string, std::map<std::string, int>> verdicts;
};

struct PooledTable {
  std::vector<Quantity> quantities;
  std::vector<PooledPoint> points;  ///< of each point of the campaign
};

[[nodiscard]] PooledTable poolCampaign(const CampaignData& data);

/// campaign.csv: a row per run. Cells without a value are empty.
[[nodiscard]] std::string runsCsv(const CampaignData& data);

/// points.csv: a row per point.
[[nodiscard]] std::string pointsCsv(const CampaignData& data, const PooledTable& pooled);

/// campaign.json: what was asked, both tables by column.
[[nodiscard]] std::string campaignJson(const CampaignData& data, const PooledTable& pooled);

/// "done", "stale", ... in the tables.
[[nodiscard]] const char* statusText(RowState::Kind kind);

/// The value of a numeric cell; nan if it is none.
[[nodiscard]] double numberOf(const RunResult& result, std::string_view column);

}  // namespace lab::runner::campaign
