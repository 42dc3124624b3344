// The shipped programs that read virtual senses, in the simulated world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "common/programs/fixed_of.hpp"
#include "runner/senses/virtual_senses.hpp"
#include "tests/support/world_fixture.hpp"

namespace lab::runner::sensing_programs_test {
namespace {

using Complex = std::complex<double>;
using Rng64 = std::mt19937_64;

constexpr double kPi = std::numbers::pi;
constexpr int kRobots = 20;

/// Robots in an arena whose senses are written at equal intervals.
class SensingRobots {
 public:
  SensingRobots(const Program& program, const SenseSpec& sense, double period, sim::Arena arena,
                std::uint64_t seed)
      : world_(hardware(arena, seed), sim::robots(kRobots)),
        sense_(sense),
        period_us_(std::llround(period * 1e6)) {
    dynamics::CoreSettings settings = sim::always(program);
    settings.reversal.enabled = false;  // after a reversal holds begin at other times
    sim::startAll(world_, settings);
  }

  [[nodiscard]] const sim::World& world() const { return world_; }

  /// Writes the senses, and advances to the next writing.
  void advance() {
    std::vector<SensedPose> poses;
    for (std::size_t i = 0; i < world_.size(); ++i) {
      const dynamics::Pose pose = world_.pose(i);
      poses.push_back({world_.id(i), pose.x, pose.y, pose.theta});
    }
    const std::vector<SenseValues> values = virtualSenses({sense_}, poses, {});
    for (std::size_t i = 0; i < world_.size(); ++i) {
      world_.order(i, [&](dynamics::RobotCore& core, std::uint32_t now_ms) {
        core.advanceTo(now_ms);
        core.setSense(0, fixedOf(values[i][0]));
      });
    }
    world_.advanceTo(world_.timeUs() + period_us_);
  }

 private:
  static sim::WorldSettings hardware(sim::Arena arena, std::uint64_t seed) {
    sim::WorldSettings settings = sim::idealHardware();
    settings.arena = arena;
    settings.seed = seed;
    return settings;
  }

  sim::World world_;
  SenseSpec sense_;
  std::int64_t period_us_;
};

SenseSpec sense(SenseKind kind, double radius) {
  SenseSpec spec;
  spec.kind = kind;
  spec.radius = radius;
  return spec;
}

struct Estimate {
  double mean = 0;
  double error = 0;
};

Estimate estimate(const std::vector<double>& values) {
  double sum = 0;
  double squares = 0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(values.size());
  return {sum / n, std::sqrt((squares / n - sum * sum / n / n) / (n - 1))};
}

double zOf(const Estimate& a, const Estimate& b) {
  return std::abs(a.mean - b.mean) / std::hypot(a.error, b.error);
}

constexpr double kPeriod = 0.1;  // [s] of senses and holds
constexpr int kForget = 300;     // periods until the order is stationary
constexpr int kPeriods = 600;

/// The squared length of the mean heading.
double order(const std::vector<double>& headings) {
  Complex sum = 0;
  for (const double heading : headings) sum += std::polar(1.0, heading);
  return std::norm(sum / static_cast<double>(headings.size()));
}

/// The mean squared polar order of robots that all sense each other: the places do not matter.
double orderOfRobots(const char* align, std::uint64_t seed) {
  SensingRobots robots(shippedProgram("vicsek", {{"align", align}}),
                       sense(SenseKind::kMeanHeading, 1000), kPeriod, {100, 100}, seed);
  double sum = 0;
  for (int k = 0; k < kPeriods; ++k) {
    robots.advance();
    std::vector<double> headings;
    for (std::size_t i = 0; i < robots.world().size(); ++i) {
      headings.push_back(robots.world().pose(i).theta);
    }
    if (k >= kForget) sum += order(headings) / (kPeriods - kForget);
  }
  return sum;
}

/// The same from an independent simulation of the headings.
double orderOfHeadings(double align, std::uint64_t seed) {
  Rng64 rng(seed);
  const auto uniform = [&rng](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng);
  };
  std::vector<double> headings(kRobots);
  std::vector<double> rates(kRobots, 0.0);
  std::vector<double> delays(kRobots);  // of each robot's holds to the writing of the senses
  for (double& heading : headings) heading = uniform(-kPi, kPi);
  for (double& delay : delays) delay = uniform(0, 0.02);
  double sum = 0;
  for (int k = 0; k < kPeriods; ++k) {
    Complex all = 0;
    for (const double heading : headings) all += std::polar(1.0, heading);
    for (std::size_t i = 0; i < headings.size(); ++i) {
      const Complex own = std::polar(1.0, headings[i]);
      const double relative = std::arg((all - own) / own);
      headings[i] += rates[i] * delays[i];
      rates[i] = std::clamp(align * relative, -4.0, 4.0) + uniform(-1, 1);
    }
    for (std::size_t i = 0; i < headings.size(); ++i) {
      headings[i] += rates[i] * (kPeriod - delays[i]);
    }
    if (k >= kForget) sum += order(headings) / (kPeriods - kForget);
  }
  return sum;
}

template <typename Make>
Estimate over(int films, std::uint64_t first_seed, const Make& make) {
  std::vector<double> values;
  for (int i = 0; i < films; ++i) values.push_back(make(first_seed + static_cast<unsigned>(i)));
  return estimate(values);
}

TEST(Vicsek, OrdersTheHeadingsAsAnIndependentSimulation) {
  const Estimate dut = over(20, 1, [](std::uint64_t seed) { return orderOfRobots("2 1/s", seed); });
  EXPECT_GT(dut.mean, 0.98);
  const auto headings = [](double align) {
    return over(200, 1000, [align](std::uint64_t seed) { return orderOfHeadings(align, seed); });
  };
  EXPECT_LT(zOf(dut, headings(2)), 4) << dut.mean << " " << headings(2).mean;
  EXPECT_GT(zOf(dut, headings(1.5)), 4) << "the test must be able to fail";
}

TEST(Vicsek, HasTheOrderOfIndependentHeadingsWithoutAlignment) {
  const Estimate dut = over(60, 1, [](std::uint64_t seed) { return orderOfRobots("0 1/s", seed); });
  EXPECT_LT(std::abs(dut.mean - 1.0 / kRobots), 4 * dut.error) << dut.mean;
  EXPECT_LT(dut.error, 0.2 / kRobots);
}

TEST(QuorumSensing, SlowsARobotDownAsSoonAsTheThresholdOfNeighboursIsReached) {
  constexpr double kRadius = 0.2;  // [m]
  constexpr std::size_t kThreshold = 3;
  // The holds last 0.2 s too, so each one begins with the values written last.
  SensingRobots robots(shippedProgram("quorum_sensing"), sense(SenseKind::kNeighbours, kRadius),
                       0.2, {}, 7);
  robots.advance();
  std::map<std::size_t, std::set<long>> speeds;  // [10 um/s], by the number of neighbours
  std::map<std::size_t, int> seen;
  for (int k = 0; k < 600; ++k) {
    std::vector<std::size_t> neighbours;
    for (std::size_t i = 0; i < robots.world().size(); ++i) {
      const dynamics::Pose own = robots.world().pose(i);
      std::size_t count = 0;
      for (std::size_t j = 0; j < robots.world().size(); ++j) {
        const dynamics::Pose other = robots.world().pose(j);
        if (j != i && std::hypot(other.x - own.x, other.y - own.y) <= kRadius) ++count;
      }
      neighbours.push_back(count);
    }
    robots.advance();
    for (std::size_t i = 0; i < neighbours.size(); ++i) {
      const sim::RobotState state = robots.world().state(i);
      speeds[neighbours[i]].insert(
          std::lround((state.program_left + state.program_right) / 2 * 1e5));
      ++seen[neighbours[i]];
    }
  }
  for (const auto& [count, values] : speeds) {
    EXPECT_EQ(values, (std::set<long>{count < kThreshold ? 6000 : 1000})) << count;
  }
  for (std::size_t count = 0; count <= 5; ++count) EXPECT_GT(seen[count], 100) << count;
}

}  // namespace
}  // namespace lab::runner::sensing_programs_test
