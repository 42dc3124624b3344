// A crowd of active Brownian particles beside an independent simulation of hard disks.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/math/random.hpp"
#include "tests/support/world_fixture.hpp"

namespace lab::sim::world_crowd_reference_test {
namespace {

constexpr std::size_t kRobots = 20;
constexpr int kRuns = 8;
constexpr int kSamples = 6000;  // of a run, each 0.1 s
constexpr double kSample = 0.1;
constexpr std::array<std::size_t, 4> kLags = {10, 30, 100, 300};
constexpr double kSpeed = 0.05;
constexpr double kEpsilon = 0.5;
constexpr double kEta = 3;
constexpr double kRadius = 0.0375;
constexpr Arena kArena{1.2, 0.9};

/// Share of robots in contact, share of robots that stand, and MSD after 1, 3, 10 and 30 s.
using Figures = std::array<double, 6>;

/// One run: where the robots are, and how many are in contact.
struct Sample {
  std::vector<Vec> centres;
  int in_contact = 0;
};

Figures figuresOf(const std::vector<Sample>& run) {
  Figures figures{};
  const auto squared = [&](std::size_t k, std::size_t lag, std::size_t i) {
    const Vec a = run[k].centres[i];
    const Vec b = run[k + lag].centres[i];
    return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
  };
  const auto mean = [&](std::size_t lag, const auto& value) {
    double sum = 0;
    for (std::size_t k = 0; k + lag < run.size(); ++k) {
      for (std::size_t i = 0; i < kRobots; ++i) sum += value(squared(k, lag, i));
    }
    return sum / static_cast<double>((run.size() - lag) * kRobots);
  };
  for (const Sample& sample : run) {
    figures[0] += sample.in_contact / static_cast<double>(kRobots * run.size());
  }
  const double slow = 0.1 * kSpeed * kSample;
  figures[1] = mean(1, [&](double moved) { return moved < slow * slow ? 1.0 : 0.0; });
  std::size_t figure = 2;
  for (const std::size_t lag : kLags) {
    figures[figure++] = mean(lag, [](double moved) { return moved; });
  }
  return figures;
}

std::vector<Sample> runWorld(std::uint64_t seed) {
  WorldSettings settings = idealHardware();
  settings.seed = seed;
  settings.boot_spread = 1;
  settings.contact_friction = 0;
  World world(settings, robots(kRobots));
  dynamics::CoreSettings core = always(abpProgram(kSpeed, kEpsilon, kEta));
  core.reversal.enabled = false;
  startAll(world, core);
  world.advanceTo(60 * kSecond);
  std::vector<Sample> run;
  for (int k = 0; k < kSamples; ++k) {
    world.advanceTo(world.timeUs() + 100'000);
    Sample sample;
    for (std::size_t i = 0; i < kRobots; ++i) {
      sample.centres.push_back({world.pose(i).x, world.pose(i).y});
      const RobotState state = world.state(i);
      sample.in_contact += state.contact_robot || state.contact_wall ? 1 : 0;
    }
    run.push_back(std::move(sample));
  }
  return run;
}

/// Disks that turn at a rate that is drawn anew every epsilon, in steps of 2 ms. Overlaps are
/// removed pair by pair, half by each disk.
class Reference {
 public:
  explicit Reference(std::uint64_t seed) : random_(seed) {
    while (disks_.size() < kRobots) {
      Disk disk;
      disk.centre = {kRadius + random_.uniform() * (kArena.width - 2 * kRadius),
                     kRadius + random_.uniform() * (kArena.height - 2 * kRadius)};
      if (std::ranges::any_of(disks_, [&](const Disk& other) {
            return std::hypot(other.centre.x - disk.centre.x, other.centre.y - disk.centre.y) <
                   2 * kRadius;
          })) {
        continue;
      }
      disk.theta = 7 * random_.uniform();
      disk.held_for = kEpsilon * random_.uniform();
      disk.turn = kEta * (2 * random_.uniform() - 1);
      disks_.push_back(disk);
    }
  }

  void step() {
    ++steps_;
    for (Disk& disk : disks_) {
      disk.held_for -= kStep;
      if (disk.held_for <= 0) {
        disk.held_for += kEpsilon;
        disk.turn = kEta * (2 * random_.uniform() - 1);
      }
      const double middle = disk.theta + disk.turn * kStep / 2;
      disk.theta += disk.turn * kStep;
      disk.centre.x += kSpeed * kStep * std::cos(middle);
      disk.centre.y += kSpeed * kStep * std::sin(middle);
    }
    for (int sweep = 0; sweep < 500 && removeOverlaps() > 1e-7; ++sweep) {
    }
  }

  std::vector<Sample> run(int samples) {
    std::vector<Sample> run;
    for (int k = 0; k < samples; ++k) {
      for (int step = 0; step < 50; ++step) this->step();
      Sample sample;
      for (const Disk& disk : disks_) {
        sample.centres.push_back(disk.centre);
        sample.in_contact += disk.pressed_at > steps_ - 5 ? 1 : 0;  // in the last 10 ms
      }
      run.push_back(std::move(sample));
    }
    return run;
  }

 private:
  static constexpr double kStep = 0.002;

  struct Disk {
    Vec centre;
    double theta = 0;
    double turn = 0;
    double held_for = 0;
    std::int64_t pressed_at = -100;
  };

  double removeOverlaps() {
    double deepest = 0;
    for (std::size_t i = 0; i < kRobots; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Vec apart = {disks_[i].centre.x - disks_[j].centre.x,
                           disks_[i].centre.y - disks_[j].centre.y};
        const double squared = apart.x * apart.x + apart.y * apart.y;
        if (squared >= 4 * kRadius * kRadius) continue;
        const double distance = std::sqrt(squared);
        const double half = (2 * kRadius - distance) / 2;
        const Vec move = {half * apart.x / distance, half * apart.y / distance};
        disks_[i].centre = {disks_[i].centre.x + move.x, disks_[i].centre.y + move.y};
        disks_[j].centre = {disks_[j].centre.x - move.x, disks_[j].centre.y - move.y};
        disks_[i].pressed_at = disks_[j].pressed_at = steps_;
        deepest = std::max(deepest, 2 * half);
      }
    }
    for (Disk& disk : disks_) {
      const Vec inside = {std::clamp(disk.centre.x, kRadius, kArena.width - kRadius),
                          std::clamp(disk.centre.y, kRadius, kArena.height - kRadius)};
      const double moved =
          std::max(std::fabs(inside.x - disk.centre.x), std::fabs(inside.y - disk.centre.y));
      if (moved == 0) continue;
      disk.centre = inside;
      disk.pressed_at = steps_;
      deepest = std::max(deepest, moved);
    }
    return deepest;
  }

  Random random_;
  std::int64_t steps_ = 0;
  std::vector<Disk> disks_;
};

struct Moments {
  double mean = 0;
  double error = 0;  ///< Standard error over the runs.
};

Moments momentsOf(const std::vector<Figures>& runs, std::size_t figure) {
  double sum = 0;
  double sum2 = 0;
  for (const Figures& run : runs) {
    sum += run[figure];
    sum2 += run[figure] * run[figure];
  }
  const auto n = static_cast<double>(runs.size());
  return {sum / n, std::sqrt(std::max(0.0, sum2 / n - sum * sum / n / n) / (n - 1))};
}

TEST(WorldCrowdReference, ContactsAndDisplacementsAreThoseOfHardDisksThatSlide) {
  std::vector<Figures> found;
  std::vector<Figures> expected;
  for (int k = 1; k <= kRuns; ++k) {
    const auto seed = static_cast<std::uint64_t>(k);
    found.push_back(figuresOf(runWorld(seed)));
    Reference reference(100 + seed);
    reference.run(600);
    expected.push_back(figuresOf(reference.run(kSamples)));
  }
  const std::array<const char*, 6> names = {"in contact", "standing", "MSD 1 s",
                                            "MSD 3 s",    "MSD 10 s", "MSD 30 s"};
  for (std::size_t figure = 0; figure < names.size(); ++figure) {
    const Moments a = momentsOf(found, figure);
    const Moments b = momentsOf(expected, figure);
    EXPECT_LT(std::fabs(a.mean - b.mean) / std::hypot(a.error, b.error), 4)
        << names[figure] << ": " << a.mean << " +- " << a.error << ", expected " << b.mean << " +- "
        << b.error;
    if (figure != 1) {
      EXPECT_LT(a.error / a.mean, 0.1) << names[figure] << " is too uncertain";
    }
  }
}

}  // namespace
}  // namespace lab::sim::world_crowd_reference_test
