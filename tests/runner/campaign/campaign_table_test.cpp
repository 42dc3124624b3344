#include "runner/campaign/campaign_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "runner/campaign/campaign_figures.hpp"
#include "runner/campaign/campaign_laws.hpp"
#include "runner/campaign/campaign_page.hpp"
#include "runner/campaign/figure_panels.hpp"
#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner::campaign::campaign_table_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// D_r = epsilon eta^2 / 6 at 3 x 3 points, two runs each, the second higher by 2 %.
CampaignData sampleData() {
  CampaignData data;
  data.request.name = "sample";
  data.request.over = {"programs.abp.eta_rad_s=1,2,3", "programs.abp.epsilon_s=0.1,0.2,0.4"};
  data.request.seeds = 2;
  data.code = {"0.1.0", 5};
  data.axes = data.request.design().axes;
  for (PointValues& values : pointsOf(data.request.design())) {
    const std::string text = values[0] + " " + values[1];
    data.points.push_back(makePoint(std::move(values), text, 60));
  }
  data.rows = rowsOf(data.request, data.points, data.code);
  for (const Row& row : data.rows) {
    const PointValues& values = data.points[row.point].values;
    const double eta = numberIn(values[0]).value();
    const double exact = numberIn(values[1]).value() * eta * eta / 6;
    const double value = exact * (row.replicate == 0 ? 0.99 : 1.01);
    RunResult result;
    result.identity = row.identity;
    result.code = "0.1.0";
    result.columns = {{"abp.verdict", row.point == 0 ? "disagrees" : "agrees"},
                      {"live.began", "2026-01-31T12:00:00Z"},
                      {"abp.robots", 1.0},
                      {"abp.v_cm_s", 3.0 + 0.001 * static_cast<double>(row.replicate)},
                      {"abp.v_cm_s.standard_error", 0.001},
                      {"abp.v_cm_s.theory", 3.0},
                      {"abp.D_r_rad2_s", value},
                      {"abp.D_r_rad2_s.standard_error", 0.014 * exact},
                      {"abp.D_r_rad2_s.low95", value - 0.03 * exact},
                      {"abp.D_r_rad2_s.high95", value + 0.03 * exact},
                      {"abp.D_r_rad2_s.theory", exact},
                      {"abp.D_r_rad2_s.effective_samples", 10000.0}};
    data.survey.rows.push_back({RowState::Kind::kDone, std::move(result), {}});
  }
  return data;
}

std::vector<std::vector<std::string>> parseCsv(const std::string& text) {
  std::vector<std::vector<std::string>> table;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char letter : line) {
      if (letter == '"') {
        quoted = !quoted;
      } else if (letter == ',' && !quoted) {
        cells.emplace_back();
      } else {
        cells.back() += letter;
      }
    }
    table.push_back(std::move(cells));
  }
  return table;
}

std::size_t columnOf(const std::vector<std::vector<std::string>>& table, const std::string& name) {
  const auto found = std::ranges::find(table[0], name);
  EXPECT_NE(found, table[0].end()) << name;
  return static_cast<std::size_t>(found - table[0].begin());
}

TEST(CampaignTable, HasARowPerRun) {
  CampaignData data = sampleData();
  data.survey.rows[3] = {RowState::Kind::kFailed, {}, "no memory"};
  data.survey.rows[4].kind = RowState::Kind::kStale;
  data.survey.rows[5].result->faults = {"a fault"};
  const auto table = parseCsv(runsCsv(data));

  ASSERT_EQ(table.size(), 19U);
  for (const auto& row : table) EXPECT_EQ(row.size(), table[0].size());
  const std::size_t status = columnOf(table, "status");
  EXPECT_EQ(table[1][status], "done");
  EXPECT_EQ(table[4][status], "failed");
  EXPECT_EQ(table[5][status], "stale");
  EXPECT_EQ(table[6][columnOf(table, "faults")], "1");
  EXPECT_EQ(table[2][columnOf(table, "programs.abp.epsilon_s")], "0.2");
  EXPECT_EQ(table[1][columnOf(table, "abp.verdict")], "disagrees");
  EXPECT_EQ(table[4][columnOf(table, "abp.D_r_rad2_s")], "");
  EXPECT_EQ(table[18][columnOf(table, "abp.v_cm_s")], "3.001");
}

TEST(CampaignTable, QuotesWhatCsvWouldSplit) {
  CampaignData data = sampleData();
  data.points[0].values[0] = "[1, \"x\"]";

  EXPECT_THAT(runsCsv(data), HasSubstr(",\"[1, \"\"x\"\"]\",0.1,"));
}

TEST(CampaignTable, PoolsTheRunsOfEachPoint) {
  const CampaignData data = sampleData();
  const PooledTable pooled = poolCampaign(data);
  const auto table = parseCsv(pointsCsv(data, pooled));

  ASSERT_EQ(table.size(), 10U);
  for (const auto& row : table) EXPECT_EQ(row.size(), table[0].size());
  EXPECT_EQ(table[1][columnOf(table, "runs")], "2");
  EXPECT_EQ(table[1][columnOf(table, "abp.verdict.disagrees")], "2");
  EXPECT_EQ(table[2][columnOf(table, "abp.verdict.agrees")], "2");
  EXPECT_EQ(pooled.points[0].verdicts.size(), 1U) << "other texts are no verdicts";
  EXPECT_NEAR(std::stod(table[9][columnOf(table, "abp.D_r_rad2_s")]), 0.6, 1e-6);
  EXPECT_EQ(table[9][columnOf(table, "abp.D_r_rad2_s.theory")], "0.6");
  const double low = std::stod(table[9][columnOf(table, "abp.D_r_rad2_s.low95")]);
  EXPECT_LT(low, 0.6);
  EXPECT_GT(low, 0.58);
}

TEST(CampaignTable, IsTheSameAsJson) {
  const CampaignData data = sampleData();
  const PooledTable pooled = poolCampaign(data);
  const auto json = nlohmann::json::parse(campaignJson(data, pooled));

  EXPECT_EQ(json["counts"]["done"], 18);
  EXPECT_EQ(json["axes"][0]["unit"], "rad/s");
  EXPECT_EQ(json["runs"]["abp.D_r_rad2_s"].size(), 18U);
  EXPECT_EQ(json["runs"]["programs.abp.eta_rad_s"][8], 3);
  EXPECT_EQ(json["points"]["programs.abp.epsilon_s"][2], 0.4);
  EXPECT_EQ(json["points"]["quantities"]["abp.D_r_rad2_s"]["mean"].size(), 9U);
  EXPECT_EQ(json["points"]["quantities"]["abp.v_cm_s"]["theory"][0], 3);
}

TEST(CampaignLaws, NameQuantitiesForPeople) {
  EXPECT_EQ(labelOf("abp.D_r_rad2_s").text(), "D_r of abp (rad²/s)");
  EXPECT_EQ(labelOf("rtp.gamma_per_s").text(), "γ of rtp (1/s)");
  EXPECT_EQ(labelOf("abp.v_cm_s").text(), "v of abp (cm/s)");
  EXPECT_EQ(labelOf("duration_s").text(), "duration (s)");
  EXPECT_EQ(labelOf("collective.speed_cm_s").text(), "speed of all robots (cm/s)");
  EXPECT_EQ(labelOf("collective.abp.polar_order").text(), "polar_order of abp");
  EXPECT_EQ(labelOf("swarm.collective.polarisation").text(), "collective.polarisation of swarm");
}

TEST(CampaignLaws, LeadWithTheQuantityWhoseLawVaries) {
  const PooledTable pooled = poolCampaign(sampleData());
  const std::vector<std::size_t> leading = leadingQuantities(pooled, {}, 6);

  ASSERT_EQ(leading.size(), 2U);
  EXPECT_EQ(pooled.quantities[leading[0]].name, "abp.D_r_rad2_s");
  EXPECT_EQ(pooled.quantities[leadingQuantities(pooled, {"v_cm_s"}, 6)[0]].name, "abp.v_cm_s");
  EXPECT_THROW(static_cast<void>(leadingQuantities(pooled, {"D_x"}, 6)), UserError);
}

TEST(CampaignLaws, FindThePowerLawAndThatOfTheExactLaw) {
  const CampaignData data = sampleData();
  const PooledTable pooled = poolCampaign(data);
  const auto law = powerLawOf(data, pooled, leadingQuantities(pooled, {}, 1)[0]);

  ASSERT_TRUE(law.has_value());
  ASSERT_TRUE(law->exact.has_value());
  EXPECT_NEAR(law->exact->prefactor.value, 1.0 / 6, 1e-6);
  EXPECT_NEAR(law->measured.prefactor.value, 1.0 / 6, 1e-3);
  EXPECT_NEAR(law->measured.exponents[0].value, 2, 1e-3);
  EXPECT_NEAR(law->measured.exponents[1].value, 1, 1e-3);
}

TEST(CampaignLaws, CountTheIntervalsThatHoldTheLaw) {
  CampaignData data = sampleData();
  const PooledTable pooled = poolCampaign(data);
  const std::size_t quantity = leadingQuantities(pooled, {}, 1)[0];
  EXPECT_EQ(agreementOf(pooled, quantity).held, 9);

  // Every run of three points is wrong by half.
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (data.rows[i].point / 3 != 1) continue;
    for (auto& [name, cell] : data.survey.rows[i].result->columns) {
      if (name == "abp.D_r_rad2_s") cell = std::get<double>(cell) * 1.5;
    }
  }
  const LawAgreement agreement = agreementOf(poolCampaign(data), quantity);
  EXPECT_EQ(agreement.held, 6);
  EXPECT_LT(agreement.p, 1e-3);
  EXPECT_GT(agreement.largest, 3);
}

TEST(CampaignFigures, LayTheKeysOutByTheNumberOfTheirValues) {
  CampaignData data = sampleData();
  data.axes.push_back(parseAxis("program=abp,rtp"));
  for (Point& point : data.points) point.values.emplace_back("abp");
  const Layout layout = layoutOf(data);

  EXPECT_EQ(layout.x, 0U);
  EXPECT_EQ(layout.series, std::vector<std::size_t>{1});
  EXPECT_EQ(layout.panels, std::vector<std::size_t>{2});
  EXPECT_TRUE(hasMap(data));
}

TEST(CampaignFigures, DrawIntervalsAndTheLaw) {
  const CampaignData data = sampleData();
  const PooledTable pooled = poolCampaign(data);
  const report::ScriptedFigure figure =
      curveFigure(data, pooled, leadingQuantities(pooled, {}, 1)[0]);

  EXPECT_THAT(figure.name, StartsWith("curve_abp"));
  EXPECT_THAT(figure.script, HasSubstr("yerrorbars"));
  EXPECT_THAT(figure.script, HasSubstr("exact law"));
  EXPECT_THAT(figure.script, HasSubstr("ε = 0.4 s"));
  EXPECT_THAT(figure.script, HasSubstr("D_r of abp (rad²/s)"));
}

/// As a stranger may write it: points of a grid, of which each has other values of all keys.
CampaignData scatteredGrid(std::size_t axes, std::size_t points) {
  CampaignData data;
  for (std::size_t i = 0; i < axes; ++i) {
    data.axes.push_back(parseAxis("key" + std::to_string(i) + "=1,2,3"));
  }
  for (std::size_t i = 0; i < points; ++i) {
    data.points.push_back(makePoint(PointValues(axes, std::to_string(i)), std::to_string(i), 60));
  }
  return data;
}

TEST(CampaignFigures, CombineNoMoreValuesThanThereArePoints) {
  std::vector<std::size_t> axes(12);
  std::iota(axes.begin(), axes.end(), std::size_t{0});

  // All combinations would be 10^12.
  const std::vector<Fixed> all = combinationsOf(scatteredGrid(12, 10), axes);

  ASSERT_EQ(all.size(), 10U);
  for (const auto& [axis, value] : all[2]) EXPECT_EQ(value, "2") << axis;
}

TEST(CampaignFigures, CombineValuesInTheirOrder) {
  const CampaignData data = sampleData();

  const std::vector<Fixed> all = combinationsOf(data, {0, 1});

  ASSERT_EQ(all.size(), 9U);
  EXPECT_EQ(all[0], (Fixed{{0, "1"}, {1, "0.1"}}));
  EXPECT_EQ(all[1], (Fixed{{0, "1"}, {1, "0.2"}}));
  EXPECT_EQ(all[8], (Fixed{{0, "3"}, {1, "0.4"}}));
  EXPECT_EQ(combinationsOf(data, {}), std::vector<Fixed>(1));
}

TEST(CampaignFigures, MapNoCellsWithoutPoints) {
  EXPECT_FALSE(hasMap(scatteredGrid(2, 9)));
  EXPECT_TRUE(hasMap(sampleData()));
}

TEST(CampaignPage, IsNotDrawnThroughALinkOfItsFolder) {
  namespace fs = std::filesystem;
  const TemporaryFolder temporary;
  const fs::path folder = temporary / "campaign";
  const fs::path elsewhere = temporary / "elsewhere";
  fs::create_directory(folder);
  support::writeFile(elsewhere / "figures.gp", "mine");
  // The number of this process can be guessed.
  fs::create_directory_symlink(elsewhere, folder / (".figures-" + std::to_string(getpid())));

  static_cast<void>(writeTables(sampleData(), folder, {}));

  EXPECT_EQ(support::readFile(elsewhere / "figures.gp"), "mine");
  EXPECT_FALSE(fs::is_empty(folder / "figures"));
}

}  // namespace
}  // namespace lab::runner::campaign::campaign_table_test
