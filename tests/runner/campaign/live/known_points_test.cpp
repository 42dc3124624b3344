#include "runner/campaign/live/known_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

using testing::ElementsAre;

PooledNumber number(int runs, double mean, double sigma) {
  PooledNumber result;
  result.runs = runs;
  result.mean = mean;
  result.sigma = sigma;
  return result;
}

PooledTable table() {
  PooledTable pooled;
  pooled.quantities = {
      {"a.D_r_rad2_s", true, true}, {"b.D_r_rad2_s", true, true}, {"faults", false, false}};
  const double none = std::numeric_limits<double>::quiet_NaN();
  pooled.points.resize(4);
  pooled.points[0].numbers = {number(3, 1, 0.01), number(3, -2, 0.02), number(3, 0, none)};
  pooled.points[1].numbers = {number(3, 1, 0.03), number(3, 2, 0.02), number(3, 0, none)};
  pooled.points[2].numbers = {number(1, 1, 0.01), number(1, 2, 0.02), number(1, 0, none)};
  pooled.points[3].numbers = {number(0, none, none), number(0, none, none), number(0, none, none)};
  return pooled;
}

TEST(KnownPoints, AreThoseWhoseEstimatesAreAllKnown) {
  EXPECT_THAT(knownPoints(table(), {{"D_r_rad2_s", 0.011}}), ElementsAre(0));
  EXPECT_THAT(knownPoints(table(), {{"b.D_r_rad2_s", 0.011}}), ElementsAre(0, 1));
  EXPECT_THAT(knownPoints(table(), {{"D_r_rad2_s", 0.05}, {"b.D_r_rad2_s", 0.001}}), ElementsAre());
  EXPECT_THAT(knownPoints(table(), {}), ElementsAre());
  EXPECT_THAT(knownPoints({}, {{"D_r_rad2_s", 0.01}}), ElementsAre());
}

TEST(KnownPoints, AnUnknownEstimateIsAnError) {
  EXPECT_THROW(static_cast<void>(knownPoints(table(), {{"D_rr", 0.01}})), UserError);
  EXPECT_THROW(static_cast<void>(knownPoints(table(), {{"faults", 0.01}})), UserError);
}

}  // namespace
}  // namespace lab::runner::campaign
