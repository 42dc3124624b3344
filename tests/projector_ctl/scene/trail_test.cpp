#include "projector_ctl/scene/trail.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

namespace lab::projector::trail_test {
namespace {

constexpr std::int64_t kStart = 1'000'000'000'000;  // [us]

std::int64_t at(double seconds) {
  return kStart + static_cast<std::int64_t>(std::llround(seconds * 1e6));
}

Trail::Settings settings() {
  return {.width = 1.2, .height = 0.9, .radius = 0.03, .rate = 2, .decay = 0.1, .diffusion = 1e-4};
}

TEST(Trail, HasSquareCellsThatCoverTheArena) {
  const Trail lab_arena(settings());
  EXPECT_EQ(lab_arena.columns(), 160);
  EXPECT_EQ(lab_arena.rows(), 120);
  EXPECT_DOUBLE_EQ(lab_arena.cell(), 0.0075);
  Trail::Settings narrow = settings();
  narrow.width = 0.5;
  narrow.height = 2;
  const Trail narrow_arena(narrow);
  EXPECT_EQ(narrow_arena.rows(), 120);
  EXPECT_GE(narrow_arena.columns() * narrow_arena.cell(), 0.5 - 1e-12);
  Trail::Settings shared = settings();
  shared.most_cells = 9600;
  const Trail half(shared);
  EXPECT_LE(half.columns() * half.rows(), 9600);
  EXPECT_GT(half.columns() * half.rows(), 9300);
}

/// A robot on a billiard path that stands in a corner for a while.
struct Walker {
  double x, y, vx, vy;
  void move(double time) {
    x += vx * time;
    y += vy * time;
    if (x < 0.0375 || x > 1.2 - 0.0375) vx = -vx, x = std::clamp(x, 0.0375, 1.2 - 0.0375);
    if (y < 0.0375 || y > 0.9 - 0.0375) vy = -vy, y = std::clamp(y, 0.0375, 0.9 - 0.0375);
  }
};

TEST(Trail, KeepsItsMassBalanceForMinutes) {
  // M' = n source - decay M while n robots are seen, with gaps of various lengths between frames.
  for (const double decay : {0.0, 0.1, 3.0}) {
    Trail::Settings trail_settings = settings();
    trail_settings.decay = decay;
    trail_settings.radius = 0.05;  // larger than the robot's distance from the wall
    trail_settings.most_cells = 4000;
    Trail dut(trail_settings);
    std::mt19937_64 random(3);
    std::uniform_int_distribution<int> frames_lost(0, 20);
    std::vector<Walker> robots{
        {0.2, 0.2, 0.1, 0.07}, {0.0375, 0.0375, 0, 0}, {0.9, 0.5, -0.2, 0.15}};
    double mass = 0;
    double worst = 0;
    int frames = 0;
    std::int64_t before = at(0);
    dut.advanceTo(before);
    while (before < at(180)) {
      const std::int64_t now = before + 16'667 * std::max(1, frames_lost(random) - 14);
      const double time = static_cast<double>(now - before) * 1e-6;
      dut.advanceTo(now);
      for (Walker& robot : robots) {
        const Walker from = robot;
        robot.move(time);
        dut.lay(from.x, from.y, before, robot.x, robot.y, now);
      }
      const double added = 3 * dut.source();
      const double kept = std::exp(-decay * time);
      mass = mass * kept + added * (decay > 0 ? (1 - kept) / decay : time);
      if (++frames % 20 == 0) worst = std::max(worst, std::abs(dut.mass() / mass - 1));
      before = now;
    }
    EXPECT_GT(frames, 5000);
    EXPECT_LT(worst, 1e-6) << "decay " << decay;
    EXPECT_GT(dut.mass(), 0.01 * dut.source());
  }
}

TEST(Trail, AccountsForTheDecaySinceALateFrame) {
  Trail late(settings());
  late.advanceTo(at(1));
  late.lay(0.5, 0.5, at(0), 0.5, 0.5, at(0.2));
  const double left = (1 - std::exp(-0.02)) / 0.1 * std::exp(-0.08);
  EXPECT_NEAR(late.mass(), late.source() * left, 1e-12);
}

TEST(Trail, ReachesRateTimesTimeUnderAStandingRobot) {
  Trail::Settings trail_settings = settings();
  trail_settings.diffusion = 0;
  Trail dut(trail_settings);
  const double middle = 80.5 * dut.cell();
  dut.advanceTo(at(2));
  dut.lay(middle, middle, at(0), middle, middle, at(2));
  const double expected = 2 * (1 - std::exp(-0.2)) / 0.1;
  EXPECT_NEAR(dut.at(80, 80), expected, 0.02 * expected);  // cells are a quarter of the radius
}

TEST(Trail, HasNoBeadsBehindAFastRobotAtASlowCamera) {
  Trail::Settings trail_settings = settings();
  trail_settings.diffusion = 0;
  trail_settings.decay = 0;
  Trail dut(trail_settings);
  for (int i = 0; i < 30; ++i) {
    dut.advanceTo(at(0.1 * (i + 1)));
    dut.lay(0.1 + 0.027 * i, 0.45, at(0.1 * i), 0.1 + 0.027 * (i + 1), 0.45, at(0.1 * (i + 1)));
  }
  double least = 1e9;
  double most = 0;
  for (int column = 30; column < 100; ++column) {
    least = std::min(least, dut.at(column, 60));
    most = std::max(most, dut.at(column, 60));
  }
  EXPECT_GT(least, 0);
  EXPECT_LT(most / least, 1.02);
}

TEST(Trail, SpreadsByTheHeatEquation) {
  Trail::Settings trail_settings = settings();
  trail_settings.decay = 0;
  Trail dut(trail_settings);
  dut.advanceTo(at(1));
  dut.lay(0.6, 0.45, at(0), 0.6, 0.45, at(1));
  const auto second_moment = [&] {
    double sum = 0;
    double square = 0;
    for (int row = 0; row < dut.rows(); ++row) {
      for (int column = 0; column < dut.columns(); ++column) {
        const double x = (column + 0.5) * dut.cell() - 0.6;
        sum += dut.at(column, row);
        square += dut.at(column, row) * x * x;
      }
    }
    return square / sum;
  };
  const double before = second_moment();
  dut.advanceTo(at(11));
  // The second moment of the scheme is exact as long as no wall is reached.
  EXPECT_NEAR(second_moment() - before, 2 * 1e-4 * 10, 1e-9);
}

TEST(Trail, BecomesUniformBetweenTheWalls) {
  Trail::Settings trail_settings = settings();
  trail_settings.decay = 0;
  trail_settings.diffusion = 0.01;
  trail_settings.most_cells = 300;
  Trail dut(trail_settings);
  dut.advanceTo(at(1));
  dut.lay(0.1, 0.1, at(0), 0.1, 0.1, at(1));
  const double mass = dut.mass();
  const double even = mass / (dut.columns() * dut.rows() * dut.cell() * dut.cell());
  dut.advanceTo(at(200));
  EXPECT_NEAR(dut.mass(), mass, 1e-12);
  EXPECT_NEAR(dut.at(0, 0), even, 1e-4 * mass);
  EXPECT_NEAR(dut.at(dut.columns() - 1, dut.rows() - 1), even, 1e-4 * mass);
}

TEST(Trail, PicturesDoNotDependOnEarlierPictures) {
  Trail watched(settings());
  Trail alone(settings());
  for (int i = 0; i < 300; ++i) {
    const std::int64_t from = at(i / 60.0);
    const std::int64_t to = at((i + 1) / 60.0);
    const double x = 0.2 + 0.002 * i;
    for (Trail* trail : {&watched, &alone}) {
      trail->advanceTo(to);
      trail->lay(x, 0.3, from, x + 0.002, 0.3, to);
    }
    if (i % 3 == 0) watched.picture(to + 60'000);
    if (i % 50 == 0) watched.picture(to + 3'000'000);
  }
  for (const double later : {0.05, 2.2, 0.4}) {
    EXPECT_EQ(watched.picture(at(5 + later))->grey, alone.picture(at(5 + later))->grey) << later;
  }
}

TEST(Trail, PictureDecaysWithoutNewFrames) {
  Trail::Settings trail_settings = settings();
  trail_settings.diffusion = 0;
  Trail dut(trail_settings);
  const double middle = 80.5 * dut.cell();
  dut.advanceTo(at(0.3));
  dut.lay(middle, middle, at(0), middle, middle, at(0.3));
  const auto byte = [&](double time) {
    return dut.picture(at(time))->grey[static_cast<std::size_t>((119 - 80) * 160 + 80)];
  };
  const double m = dut.at(80, 80);
  ASSERT_LT(m, 1);
  EXPECT_EQ(byte(0.3), std::lround(255 * m));
  EXPECT_EQ(byte(5.3), std::lround(255 * m * std::exp(-0.5)));
  EXPECT_EQ(byte(2.3), std::lround(255 * m * std::exp(-0.2)));
}

TEST(Trail, PictureIsClampedAtWhite) {
  Trail dut(settings());
  dut.advanceTo(at(10));
  dut.lay(0.6, 0.45, at(0), 0.6, 0.45, at(10));
  EXPECT_GT(dut.at(80, 60), 2);
  const auto picture = dut.picture(at(10));
  EXPECT_EQ(*std::ranges::max_element(picture->grey), 255);
  EXPECT_EQ(dut.picture(at(10)), picture) << "the same pointer while the bytes are the same";
}

/// Square cells of 2.5 mm, of which a fifth spreads to each neighbour in 0.2 s.
Trail::Settings oneShareASecond() {
  return {.width = 0.4,
          .height = 0.3,
          .radius = 0.03,
          .rate = 2,
          .decay = 0.01,
          .diffusion = 0.0025 * 0.0025};
}

TEST(Trail, AGapIsTheSameAsManyShortOnes) {
  constexpr double kShort = 0.1999;  // [s] a single sub-step, also of a gap that is a multiple
  Trail stepwise(oneShareASecond());
  stepwise.advanceTo(at(0.5));
  stepwise.lay(0.05, 0.03, at(0), 0.1, 0.2, at(0.5));
  double largest = 0;
  for (int i = 0; i < stepwise.columns() * stepwise.rows(); ++i) {
    largest = std::max(largest, stepwise.at(i % stepwise.columns(), i / stepwise.columns()));
  }
  int steps = 0;
  for (const int gap : {1, 499, 500, 501, 1000}) {
    for (; steps < gap; ++steps) stepwise.advanceTo(at(0.5 + kShort * (steps + 1)));
    Trail dut(oneShareASecond());
    dut.advanceTo(at(0.5));
    dut.lay(0.05, 0.03, at(0), 0.1, 0.2, at(0.5));
    dut.advanceTo(at(0.5 + kShort * gap));
    double worst = 0;
    for (int row = 0; row < dut.rows(); ++row) {
      for (int column = 0; column < dut.columns(); ++column) {
        EXPECT_GE(dut.at(column, row), 0);
        worst = std::max(worst, std::abs(dut.at(column, row) - stepwise.at(column, row)));
      }
    }
    EXPECT_LT(worst, 1e-12 * largest) << gap << " steps";
    EXPECT_GT(dut.mass(), 0);
  }
}

TEST(Trail, IsFlatAfterAGapOfMonths) {
  Trail::Settings slow = oneShareASecond();
  slow.decay = 1e-7;
  Trail dut(slow);
  dut.advanceTo(at(0.5));
  dut.lay(0.05, 0.03, at(0), 0.1, 0.2, at(0.5));
  const double mass = dut.mass();
  const auto later = dut.picture(at(1e7));
  const auto [least, most] = std::ranges::minmax_element(later->grey);
  EXPECT_EQ(*least, *most);

  dut.advanceTo(at(0.5 + 1e7));

  const double even = mass * std::exp(-1.0) / (0.4 * 0.3);
  EXPECT_NEAR(dut.mass(), mass * std::exp(-1.0), 1e-10 * mass);
  for (int row = 0; row < dut.rows(); ++row) {
    for (int column = 0; column < dut.columns(); ++column) {
      ASSERT_NEAR(dut.at(column, row), even, 1e-10 * even);
    }
  }
}

TEST(Trail, ALatePictureDoesNotDependOnEarlierPictures) {
  const auto laid = [] {
    auto trail = std::make_unique<Trail>(oneShareASecond());
    trail->advanceTo(at(1));
    trail->lay(0.1, 0.1, at(0), 0.15, 0.2, at(1));
    return trail;
  };
  const auto watched = laid();
  for (int i = 0; i < 200; ++i) watched->picture(at(1 + 0.1 * i));
  for (const double time : {3.2, 12.9, 21.0, 400.0}) {
    EXPECT_EQ(watched->picture(at(time))->grey, laid()->picture(at(time))->grey) << time;
  }
}

}  // namespace
}  // namespace lab::projector::trail_test
