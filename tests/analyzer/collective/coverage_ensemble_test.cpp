// Coverage of the intervals over a thousand simulated recordings.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/analyzer/collective/simulated_crowd.hpp"

namespace lab::collective::coverage_test {
namespace {

constexpr int kRecordings = 1000;
constexpr double kFrame = 0.5;  // [s]
constexpr int kFrames = 1200;   // 600 s

/// The averages of one recording by name.
std::map<std::string, Average> record(SimulatedCrowd& crowd) {
  CrowdConfig config;
  config.settings.arena = {0, 0, 1.2, 0.9};
  config.settings.diameter = 0.06;
  config.regions = {{"left", false, 0.3, 0.45, 0, 0.6, 0.9}};
  CrowdAnalysis dut(config);
  for (int k = 0; k < kFrames; ++k) {
    dut.addFrame(kFrame * k, kFrame, crowd.poses());
    crowd.step(kFrame);
  }
  const CrowdResult result = dut.results().front();
  std::map<std::string, Average> averages;
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

struct Count {
  double sum = 0;  ///< of the values
  double weight = 0;
  std::vector<Average> averages;
};

/// The intervals of each number that contain its mean over all recordings.
void expectCoverage(const SimulatedCrowdSettings& settings, double burn_in,
                    const std::map<std::string, std::pair<double, double>>& limits) {
  std::map<std::string, Count> counts;
  for (int k = 0; k < kRecordings; ++k) {
    SimulatedCrowdSettings one = settings;
    one.seed = static_cast<std::uint64_t>(k) + 1;
    SimulatedCrowd crowd(one);
    for (double time = 0; time < burn_in; time += kFrame) crowd.step(kFrame);
    for (const auto& [name, average] : record(crowd)) {
      if (std::isfinite(average.value)) counts[name].averages.push_back(average);
    }
  }
  for (const auto& [name, limit] : limits) {
    ASSERT_TRUE(counts.contains(name)) << name;
    const std::vector<Average>& averages = counts[name].averages;
    // The mean over a thousand recordings has a thirtieth of the error of one.
    double truth = 0;
    for (const Average& average : averages)
      truth += average.value / static_cast<double>(averages.size());
    double inside = 0;
    double given = 0;
    double within = 0;
    for (const Average& average : averages) {
      if (std::isnan(average.low)) continue;
      ++given;
      if (average.low <= truth && truth <= average.high) ++inside;
      within += average.independent;
    }
    std::printf("%-28s %8.4f given %5.0f covers %.1f %% independent %.0f\n", name.c_str(), truth,
                given, 100 * inside / given, within / given);
    EXPECT_GT(given, 0.9 * kRecordings) << name;
    EXPECT_GE(inside / given, limit.first) << name;
    EXPECT_LE(inside / given, limit.second) << name;
  }
}

const std::pair<double, double> kNominal{0.93, 0.97};
// A robot that has left must come back before it leaves again: successive changes exclude each
// other, and the window of the autocovariance ends before all of that is seen.
const std::pair<double, double> kConservative{0.93, 0.99};

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
                  {"bimodality", kNominal},
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
