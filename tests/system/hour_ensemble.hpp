#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/msd_accumulator.hpp"
#include "analyzer/statistics.hpp"
#include "analyzer/track_stitcher.hpp"
#include "tests/sim_svc/world_fixture.hpp"
#include "tests/system/reference_set.hpp"
#include "tests/system/simulated_film.hpp"

namespace lab::system_test {

/// Mean and scatter of one number over films.
struct Scatter {
  double n = 0;
  double sum = 0;
  double sum2 = 0;

  void add(double x) {
    n += 1;
    sum += x;
    sum2 += x * x;
  }
  [[nodiscard]] double mean() const { return sum / n; }
  /// Standard error of the mean.
  [[nodiscard]] double error() const {
    return std::sqrt((sum2 - sum * sum / n) / (n - 1) / n);
  }
};

/// One-hour films of one simulated robot.
struct HourFilms {
  ReferenceSet set;
  int films = 100;
  bool walls = true;           ///< False: a room so large that the robot meets no wall.
  bool real_hardware = false;  ///< Wheels in 256 steps and clocks that are wrong by 0.5 %.
  std::uint64_t seed = 1;
};

/// What the films gave: the curves as a lab measures them, on the lags of the table.
struct HourCurves {
  std::vector<Scatter> msd;          ///< m^2.
  std::vector<Scatter> angular_msd;  ///< rad^2.
  analysis::BlockSums total;
  analysis::StitcherCounters counters;
};

inline sim::WorldSettings worldOf(const HourFilms& dut, std::uint64_t seed) {
  constexpr double kLargeRoom = 400;  // m
  sim::WorldSettings settings = dut.real_hardware ? sim::WorldSettings{} : sim::idealHardware();
  settings.boot_spread = 0;
  settings.seed = seed;
  if (!dut.walls) {
    settings.arena = {kLargeRoom, kLargeRoom};
  }
  return settings;
}

/// One film: through the stitcher into the accumulator, as inside the analyzer.
inline analysis::BlockSums filmOneHour(const HourFilms& dut, std::uint64_t seed,
                                       analysis::StitcherCounters& counters) {
  constexpr double kHour = 3600;    // s
  constexpr double kSettled = 20;   // s: what the program began with is forgotten
  const sim::WorldSettings settings = worldOf(dut, seed);
  const std::optional<dynamics::Pose> middle =
      dut.walls ? std::nullopt
                : std::optional(dynamics::Pose{settings.arena.width / 2,
                                               settings.arena.height / 2, 0});
  sim::World world(settings, {{1, middle, false}});
  sim::startAll(world, sim::always(paramsOf(dut.set.law)));

  // The exact curves are those of a random observation phase. Frames that come a whole number of
  // times per epsilon see a few fixed phases only, so every film begins at a random instant.
  const double period = dut.set.law.epsilon > 0 ? dut.set.law.epsilon : 1;
  FilmSettings film_settings;
  film_settings.fps = dut.set.fps;
  film_settings.start_us = static_cast<std::int64_t>(
      (kSettled + period * Random(deriveSeed(seed, 1, "film start")).uniform()) * 1e6);
  world.advanceTo(film_settings.start_us);

  analysis::TrackStitcher stitcher{analysis::StitcherConfig{}};
  analysis::MsdAccumulator accumulator(dut.set.lags, 1 / dut.set.fps);
  std::vector<analysis::Sample> samples;
  const auto accumulate = [&] {
    for (const analysis::Sample& sample : samples) {
      accumulator.add(sample);
    }
    samples.clear();
  };
  SimulatedFilm film(world, film_settings);
  film.filmUntil(
      film_settings.start_us + static_cast<std::int64_t>(kHour * 1e6),
      [&](const analysis::TrackPoint& point) {
        stitcher.addFrame(point, samples);
        accumulate();
      },
      [&](const analysis::RobotTelemetry& telemetry) {
        stitcher.addTelemetry(telemetry, samples);
        accumulate();
      });
  stitcher.flush(samples);
  accumulate();
  counters = stitcher.counters();
  return accumulator.data().total();
}

inline HourCurves filmHours(const HourFilms& dut) {
  HourCurves curves;
  curves.msd.resize(dut.set.lags.size());
  curves.angular_msd.resize(dut.set.lags.size());
  for (int film = 0; film < dut.films; ++film) {
    analysis::StitcherCounters counters;
    const analysis::BlockSums sums =
        filmOneHour(dut, dut.seed + static_cast<std::uint64_t>(film), counters);
    for (std::size_t i = 0; i < dut.set.lags.size(); ++i) {
      const analysis::LagSums& lag = sums.lags[i];
      curves.msd[i].add(lag.r2 / lag.windows);
      curves.angular_msd[i].add(lag.a2 / lag.angular_windows);
    }
    curves.total += sums;
    curves.counters.reversals += counters.reversals;
    curves.counters.lost_reversals += counters.lost_reversals;
    curves.counters.in_contact += counters.in_contact;
    curves.counters.outliers += counters.outliers;
    curves.counters.uncovered += counters.uncovered;
  }
  return curves;
}

/// The largest deviation of a curve from the exact one, in standard errors of the mean over films.
struct LargestDeviation {
  double z = 0;
  double tau = 0;    ///< Where, s.
  double ratio = 1;  ///< Mean over exact there.
};

/// `floor` is the share of the exact value below which no deviation counts, as a further standard
/// error.
inline LargestDeviation largestDeviation(const ReferenceSet& set, const std::vector<Scatter>& mean,
                                         const std::vector<double>& exact, double floor = 0) {
  LargestDeviation largest;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double error = std::hypot(mean[i].error(), floor * exact[i]);
    const double z =
        analysis::normalDeviate((mean[i].mean() - exact[i]) / error, mean[i].n - 1);
    if (std::abs(z) > std::abs(largest.z)) {
      largest = {z, set.lags[i] / set.fps, mean[i].mean() / exact[i]};
    }
  }
  return largest;
}

}  // namespace lab::system_test
