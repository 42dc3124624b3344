// Coverage of the intervals over a thousand simulated recordings.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <utility>

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

/// How many intervals contain the true value.
void expectCoverage(const SimulatedCrowdSettings& settings, double burn_in,
                    const std::map<std::string, std::pair<double, double>>& limits) {
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
    const auto limit = limits.find(name);
    if (limit == limits.end()) continue;
    EXPECT_GT(count.given, 0.9 * kRecordings) << name;
    EXPECT_GE(covered, limit->second.first) << name;
    EXPECT_LE(covered, limit->second.second) << name;
  }
  for (const auto& [name, limit] : limits) EXPECT_TRUE(counts.contains(name)) << name;
}

const std::pair<double, double> kNominal{0.93, 0.97};
// A robot that has left must come back before it leaves again: successive changes exclude each
// other, and the window of the autocovariance ends before all of that is seen.
const std::pair<double, double> kConservative{0.93, 0.99};

// Not among them: the bimodality. Cells of points that overlap may be arbitrarily small, so the
// moments of the packing fraction do not exist; robots have a diameter.
TEST(CollectiveCoverage, OfIndependentRobots) {
  expectCoverage({.robots = 20, .speed = 0.1, .rotation = 1}, 0,
                 {{"polar_order", kNominal},
                  {"nematic_order", kNominal},
                  {"hexatic_order", kNominal},
                  {"largest_cluster", kNominal},
                  {"mean_cluster", kNominal},
                  {"clusters", kNominal},
                  {"clustered_share", kNominal},
                  {"speed", kNominal},
                  {"touching_share", kNominal},
                  {"contact_time", kNominal},
                  {"number_fluctuation_exponent", kNominal},
                  {"pair_distribution 18", kNominal},
                  {"pair_distribution 30", kNominal},
                  {"velocity_correlation 30", kNominal},
                  {"density_of_cells 6", kNominal},
                  {"density_of_boxes 0", kNominal},
                  {"cluster_sizes 0", kNominal},
                  {"number_fluctuations 0", kNominal},
                  {"whole_msd 0", kNominal},
                  {"left", kNominal},
                  {"flux", kConservative}});
}

// Alignment makes slow fluctuations of the order: tens of independent values in a recording.
TEST(CollectiveCoverage, OfAligningRobots) {
  expectCoverage({.robots = 20, .speed = 0.1, .rotation = 1, .alignment = 0.5}, 60,
                 {{"polar_order", kNominal},
                  {"largest_cluster", kNominal},
                  {"mean_cluster", kNominal},
                  {"local_density", kNominal},
                  {"touching_share", kNominal},
                  {"pair_distribution 12", kNominal},
                  {"velocity_correlation 12", kNominal},
                  {"whole_angular_msd 0", kNominal}});
}

}  // namespace
}  // namespace lab::collective::coverage_test
