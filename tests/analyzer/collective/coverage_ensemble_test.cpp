// Coverage of the intervals over a thousand simulated recordings.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "tests/analyzer/collective/simulated_crowd.hpp"

namespace lab::collective::coverage_test {
namespace {

constexpr double kFrame = 0.5;  // [s]
constexpr int kFrames = 1200;   // 600 s
constexpr int kRecordings = 1000;
// The true values: longer recordings with seeds of their own. Their mean has a twelfth of the error
// of a recording.
constexpr int kLongRecordings = 15;
constexpr int kTimesLonger = 10;
constexpr double kMostly = 0.9;  // share of the recordings

using Averages = std::map<std::string, Average>;

Averages record(SimulatedCrowd& crowd, int frames) {
  CrowdConfig config;
  config.settings.arena = {0, 0, 1.2, 0.9};
  config.settings.diameter = 0.06;
  config.regions = {{"left", false, 0.3, 0.45, 0, 0.6, 0.9}};
  CrowdAnalysis dut(config);
  for (int k = 0; k < frames; ++k) {
    dut.addFrame(kFrame * k, kFrame, crowd.poses());
    crowd.step(kFrame);
  }
  const CrowdResult result = dut.results().front();
  Averages averages;
  for (const Observable& number : result.numbers) averages[number.name] = number.average;
  for (const ObservableCurve& curve : result.curves) {
    for (std::size_t i = 0; i < curve.points.size(); i += 6) {
      averages[curve.name + " " + std::to_string(i)] = curve.points[i].average;
    }
  }
  averages["left"] = result.regions.shares[0];
  averages["flux"] = result.regions.flux[0][1];
  return averages;
}

Averages record(SimulatedCrowdSettings settings, std::uint64_t seed, double burn_in, int frames) {
  settings.seed = seed;
  SimulatedCrowd crowd(settings);
  for (double time = 0; time < burn_in; time += kFrame) crowd.step(kFrame);
  return record(crowd, frames);
}

struct Count {
  int given = 0;
  int inside = 0;
};

/// How many intervals contain the true value: of every average that has one in nine of ten
/// recordings. @param names averages that must have one
void expectCoverage(const SimulatedCrowdSettings& settings, double burn_in,
                    const std::vector<std::string>& names) {
  std::map<std::string, double> truth;
  for (int k = 0; k < kLongRecordings; ++k) {
    const auto seed = static_cast<std::uint64_t>(1'000'000 + k);
    for (const auto& [name, average] : record(settings, seed, burn_in, kTimesLonger * kFrames)) {
      truth[name] += average.value / kLongRecordings;
    }
  }
  std::map<std::string, Count> counts;
  for (int k = 0; k < kRecordings; ++k) {
    const auto seed = static_cast<std::uint64_t>(k + 1);
    for (const auto& [name, average] : record(settings, seed, burn_in, kFrames)) {
      if (std::isnan(average.low)) continue;
      Count& count = counts[name];
      ++count.given;
      if (average.low <= truth[name] && truth[name] <= average.high) ++count.inside;
    }
  }
  for (const auto& [name, count] : counts) {
    const double covered = 1.0 * count.inside / count.given;
    std::printf("%-30s %9.5f given %5.1f %% covers %5.1f %%\n", name.c_str(), truth[name],
                100.0 * count.given / kRecordings, 100 * covered);
    if (count.given < kMostly * kRecordings) continue;
    EXPECT_GE(covered, 0.93) << name;
    EXPECT_LE(covered, 0.97) << name;
  }
  for (const std::string& name : names) {
    EXPECT_GT(counts[name].given, kMostly * kRecordings) << name;
  }
}

// Not among them: the bimodality. Cells of points that overlap may be arbitrarily small, so the
// moments of the packing fraction do not exist; robots have a diameter.
TEST(CollectiveCoverage, OfIndependentRobots) {
  expectCoverage({.robots = 20, .speed = 0.1, .rotation = 1}, 0,
                 {"polar_order",
                  "nematic_order",
                  "hexatic_order",
                  "largest_cluster",
                  "mean_cluster",
                  "clusters",
                  "clustered_share",
                  "speed",
                  "local_density",
                  "touching_share",
                  "contact_time",
                  "wall_share",
                  "wall_time",
                  "number_fluctuation_exponent",
                  "pair_distribution 18",
                  "pair_distribution 30",
                  "velocity_correlation 30",
                  "density_of_cells 6",
                  "density_of_boxes 0",
                  "cluster_sizes 0",
                  "number_fluctuations 0",
                  "whole_msd 0",
                  "left",
                  "flux"});
}

// Alignment makes slow fluctuations of the order: tens of independent values in a recording.
TEST(CollectiveCoverage, OfAligningRobots) {
  expectCoverage(
      {.robots = 20, .speed = 0.1, .rotation = 1, .alignment = 0.5}, 60,
      {"polar_order", "largest_cluster", "mean_cluster", "local_density", "touching_share",
       "pair_distribution 12", "velocity_correlation 12", "whole_angular_msd 0", "left", "flux"});
}

}  // namespace
}  // namespace lab::collective::coverage_test
