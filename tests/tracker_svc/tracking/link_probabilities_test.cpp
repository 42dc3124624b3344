#include "tracker_svc/tracking/link_probabilities.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace lab::tracker::link_probabilities_test {
namespace {

/// Sums over all assignments by recursion.
void enumerate(const std::vector<Link>& links, std::size_t next, double weight,
               std::vector<bool>& used, std::vector<double>& sums, double& all) {
  if (next == links.size()) {
    all += weight;
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (used[i]) sums[i] += weight;
    }
    return;
  }
  enumerate(links, next + 1, weight, used, sums, all);
  for (std::size_t i = 0; i < next; ++i) {
    const bool meets =
        links[i].track == links[next].track || links[i].detection == links[next].detection;
    if (used[i] && meets) return;
  }
  used[next] = true;
  enumerate(links, next + 1, weight * links[next].weight, used, sums, all);
  used[next] = false;
}

std::vector<double> byEnumeration(const std::vector<Link>& links) {
  std::vector<bool> used(links.size(), false);
  std::vector<double> sums(links.size(), 0);
  double all = 0;
  enumerate(links, 0, 1, used, sums, all);
  for (double& sum : sums) sum /= all;
  return sums;
}

TEST(LinkProbabilities, OfASingleLink) {
  LinkProbabilities dut;
  EXPECT_DOUBLE_EQ(dut.of(std::vector<Link>{{0, 0, 3}}).front(), 0.75);
}

TEST(LinkProbabilities, AreHalfIfTwoTracksFitTwoDetectionsAlike) {
  LinkProbabilities dut;
  const std::vector<Link> links{{0, 0, 1e9}, {0, 1, 1e9}, {1, 0, 1e9}, {1, 1, 1e9}};
  for (const double p : dut.of(links)) EXPECT_NEAR(p, 0.5, 1e-6);
}

TEST(LinkProbabilities, AgreeWithTheSumOverAllAssignments) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Link> links;
    for (std::size_t track = 0; track < 4; ++track) {
      for (std::size_t detection = 0; detection < 3; ++detection) {
        if (share(random) < 0.7)
          links.push_back({track, detection, std::exp(8 * share(random) - 3)});
      }
    }
    LinkProbabilities dut;
    const std::vector<double> expected = byEnumeration(links);
    const std::vector<double>& found = dut.of(links);
    for (std::size_t i = 0; i < links.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-9);
  }
}

TEST(LinkProbabilities, OfLargeGroupsAreThoseOfSmallOnes) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  constexpr std::size_t kMany = 40;
  std::vector<Link> links;
  for (std::size_t i = 0; i < kMany; ++i) {
    for (std::size_t j = 0; j < kMany; ++j) {
      const double apart = std::abs(static_cast<double>(i) - static_cast<double>(j));
      if (apart <= 2) links.push_back({i, j, 1e6 * std::exp(-2 * apart) * (1 + share(random))});
    }
  }
  LinkProbabilities dut;
  const std::vector<double>& found = dut.of(links);
  std::vector<double> tracks(kMany, 0);
  std::vector<double> detections(kMany, 0);
  for (std::size_t k = 0; k < links.size(); ++k) {
    tracks[links[k].track] += found[k];
    detections[links[k].detection] += found[k];
  }
  for (const double sum : tracks) EXPECT_NEAR(sum, 1, 0.01);
  for (const double sum : detections) EXPECT_NEAR(sum, 1, 0.01);
  EXPECT_GT(dut.groups().size(), 1U);
  // An exchange of neighbours costs four factors of e, so the diagonal is likely everywhere.
  for (std::size_t k = 0; k < links.size(); ++k) {
    if (links[k].track != links[k].detection) continue;
    EXPECT_GT(found[k], 0.8);
  }
}

}  // namespace
}  // namespace lab::tracker::link_probabilities_test
