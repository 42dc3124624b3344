#include "tracker_svc/tracking/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "common/math/random.hpp"

namespace lab::tracker {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Problem {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> pair;   // rows x columns
  std::vector<double> alone;  // rows
};

Problem randomProblem(Random& random) {
  Problem problem;
  problem.rows = 1 + random.next() % 5;
  problem.columns = random.next() % 6;
  for (std::size_t i = 0; i < problem.rows * problem.columns; ++i) {
    problem.pair.push_back(random.uniform() < 0.3 ? kNever : 10 * random.uniform() - 5);
  }
  for (std::size_t i = 0; i < problem.rows; ++i) problem.alone.push_back(4 * random.uniform() - 2);
  return problem;
}

/// Exhaustive search. `banned_row` must not use `banned_column` (-1: stay alone).
double bestByTrying(const Problem& problem, std::size_t row, std::vector<char>& used,
                    std::size_t banned_row, int banned_column) {
  if (row == problem.rows) return 0;
  double best = kNever;
  if (row != banned_row || banned_column != -1) {
    best = problem.alone[row] + bestByTrying(problem, row + 1, used, banned_row, banned_column);
  }
  for (std::size_t column = 0; column < problem.columns; ++column) {
    if (used[column] != 0) continue;
    if (row == banned_row && static_cast<int>(column) == banned_column) continue;
    used[column] = 1;
    best = std::min(best, problem.pair[row * problem.columns + column] +
                              bestByTrying(problem, row + 1, used, banned_row, banned_column));
    used[column] = 0;
  }
  return best;
}

double bestByTrying(const Problem& problem, std::size_t banned_row, int banned_column) {
  std::vector<char> used(problem.columns, 0);
  return bestByTrying(problem, 0, used, banned_row, banned_column);
}

void load(const Problem& problem, Assignment& dut) {
  dut.reset(problem.rows, problem.columns);
  for (std::size_t row = 0; row < problem.rows; ++row) {
    dut.setAlone(row, problem.alone[row]);
    for (std::size_t column = 0; column < problem.columns; ++column) {
      const double cost = problem.pair[row * problem.columns + column];
      if (cost < kNever) dut.allow(row, column, cost);
    }
  }
}

TEST(Assignment, EqualsExhaustiveSearchInCostAndMargins) {
  Random random(20);
  Assignment dut;
  for (int run = 0; run < 3000; ++run) {
    const Problem problem = randomProblem(random);
    load(problem, dut);

    dut.solve();

    double total = 0;
    std::vector<char> used(problem.columns, 0);
    for (std::size_t row = 0; row < problem.rows; ++row) {
      const int column = dut.columnOf(row);
      if (column < 0) {
        total += problem.alone[row];
        continue;
      }
      EXPECT_EQ(used[static_cast<std::size_t>(column)]++, 0) << "given twice";
      total += problem.pair[row * problem.columns + static_cast<std::size_t>(column)];
    }
    const double best = bestByTrying(problem, problem.rows, 0);
    ASSERT_NEAR(total, best, 1e-12) << run;
    for (std::size_t row = 0; row < problem.rows; ++row) {
      const double other = bestByTrying(problem, row, dut.columnOf(row));
      if (other == kNever) {
        ASSERT_EQ(dut.margin(row), kNever) << run;
      } else {
        ASSERT_NEAR(dut.margin(row), other - best, 1e-12) << run << " row " << row;
      }
    }
  }
}

TEST(Assignment, IsBetterThanNearestFirst) {
  // Row 0 is nearest to column 0, but row 1 has no alternative.
  Assignment dut;
  dut.reset(2, 2);
  dut.allow(0, 0, 1);
  dut.allow(0, 1, 2);
  dut.allow(1, 0, 2);
  dut.setAlone(0, 50);
  dut.setAlone(1, 50);

  dut.solve();

  EXPECT_EQ(dut.columnOf(0), 1);
  EXPECT_EQ(dut.columnOf(1), 0);
}

TEST(Assignment, MarginsIncludeLongerCycles) {
  // A cycle of three rows: no two can be exchanged, but all three can be shifted.
  Assignment dut;
  dut.reset(3, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    dut.setAlone(i, 100);
    dut.allow(i, i, 0);
    dut.allow(i, (i + 1) % 3, 0.5);
  }

  dut.solve();

  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(dut.columnOf(i), static_cast<int>(i));
    EXPECT_DOUBLE_EQ(dut.margin(i), 1.5);
  }
}

TEST(Assignment, AcceptsAnEmptyProblem) {
  Assignment dut;
  dut.reset(0, 3);
  dut.solve();
  dut.reset(2, 0);
  dut.solve();

  EXPECT_EQ(dut.columnOf(0), -1);
  EXPECT_EQ(dut.margin(0), kNever);
}

}  // namespace
}  // namespace lab::tracker
