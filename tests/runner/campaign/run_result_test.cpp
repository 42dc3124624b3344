#include "runner/campaign/run_result.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lab::runner::campaign::run_result_test {
namespace {

using testing::HasSubstr;

RunResult sampleResult() {
  RunResult result;
  result.identity = {"0123456789abcdef", "01234567"};
  result.code = "0.1.0 (abc)";
  result.seed = 9223372036854775807U;
  result.faults = {"the log has a hole", "\"quoted\", \xff"};
  result.columns = {{"abp.D_r_rad2_s", 0.748123}, {"abp.verdict", "agrees"}, {"abp.v_cm_s", {}}};
  return result;
}

constexpr std::string_view kSummary = R"({
 "format": 1, "experiment": "x", "seed": 3, "duration_s": 60,
 "faults": [{"t_s": 1, "text": "a fault"}],
 "programs": [{"name": "abp", "model": "ABP", "parameters": "v = 3 cm/s",
   "pool": {"robots": 4, "verdict": "agrees", "max_z": 1.5, "joins": null,
     "estimates": {"D_r_rad2_s": {"value": 0.75, "standard_error": 0.01, "low95": 0.73,
         "high95": 0.77, "theory": 0.75, "effective_samples": 40, "note": "a note"},
       "D_slope_cm2_s": {"value": null, "standard_error": null}},
     "fit": {"refusal": null, "derived": {"D_r_rad2_s": {"value": 0.76}}, "lags_s": [1, 2]},
     "msd": {"lag_s": [1, 2]}},
   "each_robot": [{"robot": 1}],
   "collective": {"polarisation": {"value": 0.1, "standard_error": 0.02}}}],
 "clusters": {"largest": {"value": 12, "standard_error": 2}, "found": true},
 "losses": {"log": [{"channel": "A", "lost": 3}, {"channel": "B", "lost": 4}],
   "camera_frames_missing": 5}
})";

TEST(RunResult, ComesBackFromItsFile) {
  const RunResult result = sampleResult();
  const std::string text = resultText(result);
  const ReadResult read = readResult(text, result.identity);

  ASSERT_NE(read.get(), nullptr) << read.problem();
  EXPECT_EQ(read.get()->seed, result.seed);
  EXPECT_EQ(read.get()->columns, result.columns);
  EXPECT_EQ(resultText(*read.get()), text);
}

TEST(RunResult, IsRefusedWhenAnyByteOfItsFileIsDamaged) {
  const RunResult result = sampleResult();
  const std::string text = resultText(result);
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string damaged = text;
    damaged[i] = damaged[i] == '7' ? '8' : '7';
    const ReadResult read = readResult(damaged, result.identity);
    // Space between the values is not part of the result.
    if (read.get() != nullptr) {
      EXPECT_EQ(read.get()->columns, result.columns) << i;
    }
    // The last byte is the end of the line.
    if (i + 1 < text.size()) {
      EXPECT_EQ(readResult(text.substr(0, i), result.identity).get(), nullptr) << i;
    }
  }
}

TEST(RunResult, IsRefusedWhenItIsNestedDeeply) {
  constexpr std::size_t kDepth = 300'000;
  const std::string text =
      R"({"sha256": "", "columns": )" + std::string(kDepth, '[') + std::string(kDepth, ']') + "}";
  EXPECT_THAT(readResult(text, sampleResult().identity).problem(), HasSubstr("is no JSON"));
}

TEST(RunResult, IsRefusedWhenItIsOfAnotherRun) {
  const std::string text = resultText(sampleResult());

  EXPECT_THAT(readResult(text, {"0123456789abcdef", "76543210"}).problem(),
              HasSubstr("another run"));
}

TEST(RunResult, HasTheNumbersOfASummary) {
  const Columns columns = columnsOf(kSummary);
  const auto cell = [&](std::string_view name) -> Cell {
    const auto found = std::ranges::find(columns, name, &Columns::value_type::first);
    return found == columns.end() ? Cell(std::string("absent")) : found->second;
  };

  EXPECT_EQ(cell("duration_s"), Cell(60.0));
  EXPECT_EQ(cell("abp.verdict"), Cell(std::string("agrees")));
  EXPECT_EQ(cell("abp.D_r_rad2_s"), Cell(0.75));
  EXPECT_EQ(cell("abp.D_r_rad2_s.standard_error"), Cell(0.01));
  EXPECT_EQ(cell("abp.D_r_rad2_s.theory"), Cell(0.75));
  EXPECT_EQ(cell("abp.D_slope_cm2_s"), Cell());
  EXPECT_EQ(cell("abp.fit.D_r_rad2_s"), Cell(0.76));
  EXPECT_EQ(cell("lost_messages"), Cell(7.0));
  EXPECT_EQ(cell("camera_frames_missing"), Cell(5.0));
  for (const char* absent : {"seed", "format", "abp.joins", "abp.msd.lag_s", "abp.fit.lags_s"}) {
    EXPECT_EQ(cell(absent), Cell(std::string("absent"))) << absent;
  }
}

TEST(RunResult, SumsOfImpossibleCountsDoNotOverflow) {
  const Columns columns = columnsOf(
      R"({"losses": {"log": [{"lost": 9223372036854775807}, {"lost": 9223372036854775807},
                            {"lost": -9223372036854775808}]}})");
  const auto lost = std::ranges::find(columns, "lost_messages", &Columns::value_type::first);
  ASSERT_NE(lost, columns.end());
  EXPECT_EQ(lost->second, Cell(double(std::int64_t{1} << 50)));
}

TEST(RunResult, TakesSectionsOfASummaryThatItDoesNotKnow) {
  const Columns columns = columnsOf(kSummary);
  const auto has = [&](std::string_view name, double value) {
    const auto found = std::ranges::find(columns, name, &Columns::value_type::first);
    return found != columns.end() && found->second == Cell(value);
  };

  EXPECT_TRUE(has("abp.collective.polarisation", 0.1));
  EXPECT_TRUE(has("clusters.largest", 12));
  EXPECT_TRUE(has("clusters.largest.standard_error", 2));
  EXPECT_TRUE(has("clusters.found", 1));
}

TEST(RunResult, HasTheCollectiveAverages) {
  const Columns columns = columnsOf(R"({"programs": [], "collective": [
    {"robots": "all robots", "frames": 453,
     "numbers": {
       "polar_order": {"unit": "1", "value": 0.2, "standard_error": 0.02, "low95": 0.15,
                       "high95": 0.25, "independent_blocks": 17},
       "square_speed": {"unit": "cm²/s²", "value": 9, "standard_error": null}},
     "curves": {"cluster_sizes": {"size": [1, 2]}},
     "light_bands": [{"name": "dark", "share_of_time": {"unit": "1", "value": 0.3},
                      "changes_to": {"abp": {"unit": "1/s", "value": 0.1}}}]},
    {"robots": "abp", "numbers": {"contact_time": {"unit": "s", "value": 4}}}]})");
  const auto number = [&](std::string_view name) {
    const auto found = std::ranges::find(columns, name, &Columns::value_type::first);
    return found == columns.end() ? Cell(std::string("absent")) : found->second;
  };

  EXPECT_EQ(number("collective.polar_order"), Cell(0.2));
  EXPECT_EQ(number("collective.polar_order.standard_error"), Cell(0.02));
  EXPECT_EQ(number("collective.polar_order.low95"), Cell(0.15));
  EXPECT_EQ(number("collective.polar_order.effective_samples"), Cell(17.0));
  EXPECT_EQ(number("collective.square_speed_cm2_s2"), Cell(9.0));
  EXPECT_EQ(number("collective.square_speed_cm2_s2.standard_error"), Cell());
  EXPECT_EQ(number("collective.light_bands.dark.share_of_time"), Cell(0.3));
  EXPECT_EQ(number("collective.abp.contact_time_s"), Cell(4.0));
}

TEST(RunResult, NeedsASummary) {
  EXPECT_THROW(static_cast<void>(columnsOf("{cut off")), std::runtime_error);
}

}  // namespace
}  // namespace lab::runner::campaign::run_result_test
