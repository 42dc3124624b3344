/// Ensembles of simulated one-hour recordings, and their comparison with the exact laws.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/curves/estimates.hpp"
#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/curves/statistics.hpp"
#include "analyzer/tracks/track_stitcher.hpp"
#include "tests/support/world_fixture.hpp"
#include "tests/system/laws/reference_set.hpp"
#include "tests/system/laws/world_recording.hpp"

namespace lab::system_test {

/// Mean and standard error of a number over recordings.
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
  [[nodiscard]] double error() const { return std::sqrt((sum2 - sum * sum / n) / (n - 1) / n); }
};

enum class Room {
  kArena,      ///< 1.20 m x 0.90 m with walls: reversals, which are stitched
  kFreeSpace,  ///< so large that the robot meets no wall
};

enum class Hardware {
  kIdeal,  ///< wheels at any speed, exact clocks
  kReal,   ///< wheel speeds in 256 steps, clock errors of 0.5 %
};

/// Settings of the ensemble: one-hour recordings of one robot, each with its own seed and phase.
struct HourRecordings {
  std::string table;  ///< name of a table in tests/reference, without .csv
  Room room = Room::kArena;
  Hardware hardware = Hardware::kIdeal;
  int count = 100;
};

/// The measured curves at the lags of the table.
struct HourCurves {
  ReferenceSet set;
  std::vector<Scatter> msd;          ///< [m^2]
  std::vector<Scatter> angular_msd;  ///< [rad^2]
  analysis::BlockData pool;
  std::int64_t reversals = 0;  ///< reversals that were stitched
};

inline sim::WorldSettings worldOf(const HourRecordings& recordings, std::uint64_t seed) {
  constexpr double kFreeSpaceSize = 400;  // [m]
  sim::WorldSettings settings =
      recordings.hardware == Hardware::kIdeal ? sim::idealHardware() : sim::WorldSettings{};
  settings.boot_spread = 0;
  settings.seed = seed;
  if (recordings.room == Room::kFreeSpace) {
    settings.arena = {kFreeSpaceSize, kFreeSpaceSize};
  }
  return settings;
}

inline std::optional<dynamics::Pose> startIn(const sim::Arena& arena, Room room) {
  if (room == Room::kArena) {
    return std::nullopt;  // at random
  }
  return dynamics::Pose{arena.width / 2, arena.height / 2, 0};
}

/// Records one hour through stitcher and accumulator, as in the analyzer.
/// @return number of stitched reversals
inline std::int64_t recordOneHour(const HourRecordings& recordings, const ReferenceSet& set,
                                  std::uint64_t seed, analysis::MsdAccumulator& accumulator) {
  constexpr double kHour = 3600;   // [s]
  constexpr double kSettled = 20;  // [s] until the initial state has no influence
  const sim::WorldSettings settings = worldOf(recordings, seed);
  sim::World world(settings, {{1, startIn(settings.arena, recordings.room), false}});
  sim::startAll(world, sim::always(set.program));

  // The exact curves are averages over the observation phase. A frame rate that is a multiple of
  // 1 / epsilon samples only a few phases, so every recording begins at a random time.
  const double epsilon = test::parameter(set.program, "epsilon");  // nan: it has none
  const double period = epsilon > 0 ? epsilon : 1;
  Random random(deriveSeed(seed, 1, "film start"));
  RecordingSettings recording_settings;
  recording_settings.fps = set.fps;
  recording_settings.start_us = std::llround((kSettled + period * random.uniform()) * 1e6);
  world.advanceTo(recording_settings.start_us);

  analysis::TrackStitcher stitcher{analysis::StitcherConfig{}};
  std::vector<analysis::Sample> samples;
  const auto accumulate = [&] {
    for (const analysis::Sample& sample : samples) {
      accumulator.add(sample);
    }
    samples.clear();
  };
  WorldRecording recorder(world, recording_settings);
  recorder.recordUntil(
      recording_settings.start_us + std::llround(kHour * 1e6),
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
  return stitcher.counters().reversals;
}

inline HourCurves recordHours(const HourRecordings& recordings) {
  HourCurves curves;
  curves.set = readReferenceSet(recordings.table);
  const std::vector<int>& lags = curves.set.lags;
  curves.msd.resize(lags.size());
  curves.angular_msd.resize(lags.size());
  for (int i = 0; i < recordings.count; ++i) {
    analysis::MsdAccumulator accumulator(lags, 1 / curves.set.fps);
    curves.reversals +=
        recordOneHour(recordings, curves.set, deriveSeed(1, i, recordings.table), accumulator);
    const analysis::BlockSums sums = accumulator.data().total();
    for (std::size_t k = 0; k < lags.size(); ++k) {
      curves.msd[k].add(sums.lags[k].r2 / sums.lags[k].windows);
      curves.angular_msd[k].add(sums.lags[k].a2 / sums.lags[k].angular_windows);
    }
    curves.pool.pool(accumulator.data());
  }
  return curves;
}

/// The largest deviation of a curve from a law, in standard errors of the mean over the recordings.
struct Deviation {
  double z = 0;
  double tau = 0;    ///< lag of the deviation [s]
  double ratio = 1;  ///< mean divided by the law at that lag
};

inline std::ostream& operator<<(std::ostream& out, const Deviation& deviation) {
  return out << "z " << deviation.z << " (" << 100 * (deviation.ratio - 1) << " % at "
             << deviation.tau << " s)";
}

/// @param floor systematic error relative to the law, added in quadrature to the standard error
inline Deviation largestDeviation(const ReferenceSet& set, const std::vector<Scatter>& recordings,
                                  const std::vector<double>& law, double floor = 0) {
  Deviation largest;
  for (std::size_t i = 0; i < law.size(); ++i) {
    const double error = std::hypot(recordings[i].error(), floor * law[i]);
    // With few recordings the standard error is uncertain, hence Student's t distribution.
    const double z =
        analysis::normalDeviate((recordings[i].mean() - law[i]) / error, recordings[i].n - 1);
    if (std::abs(z) > std::abs(largest.z)) {
      largest = {z, set.lags[i] / set.fps, recordings[i].mean() / law[i]};
    }
  }
  return largest;
}

/// The factor by which the quantisation of the wheel speeds changes the exact MSD of the table.
///
/// v is rounded to a step of the wheel speed (5 cm/s gives 4.976 cm/s). It is measured, as in the
/// analyzer, from the displacement along the heading, not by a fit to the MSD. The MSD of ABP and
/// RTP is proportional to v^2. Random wheel speeds (noisy ABP, BP) average over the steps and need
/// no correction.
///
/// Clock errors need no correction: the clock of a recording multiplies epsilon, or 1 / gamma and
/// tau_t, by 1 + delta with a standard deviation of 0.5 %. Its mean effect vanishes to first order
/// and is 1e-5 to second order; its scatter is part of the standard error.
inline double speedFactor(const HourCurves& curves) {
  const analysis::ProgramLaw& law = curves.set.law;
  const double v = law->parameter("v");  // nan: it has none
  if (std::isnan(v)) {
    return 1;
  }
  const analysis::Estimator estimator(law, curves.pool);
  const double ratio = estimator(curves.pool.total())[analysis::kSpeed] / v;
  return ratio * ratio;
}

inline void expectExactLaw(const HourRecordings& recordings, const HourCurves& curves) {
  constexpr double kSystematicFloor = 0.002;
  constexpr double kLargestZ = 4;  // 1 % of ensembles of the true law exceed 3.2
  const bool real = recordings.hardware == Hardware::kReal;
  const double floor = real ? kSystematicFloor : 0;
  const double factor = real ? speedFactor(curves) : 1;
  std::vector<double> msd = curves.set.msd;
  for (double& value : msd) {
    value *= factor;
  }
  const Deviation translation = largestDeviation(curves.set, curves.msd, msd, floor);
  const Deviation rotation =
      largestDeviation(curves.set, curves.angular_msd, curves.set.angular_msd, floor);
  std::cout << recordings.table << ": MSD " << translation << ", angular MSD " << rotation << ", v "
            << 100 * (std::sqrt(factor) - 1) << " %, " << curves.reversals << " reversals\n";
  EXPECT_LT(std::abs(translation.z), kLargestZ) << "MSD: " << translation;
  EXPECT_LT(std::abs(rotation.z), kLargestZ) << "angular MSD: " << rotation;
  EXPECT_NEAR(factor, 1, 0.03);  // twice half a step of the wheel speed at 5 cm/s
  if (recordings.room == Room::kArena) {
    EXPECT_GT(curves.reversals, recordings.count);
  } else {
    EXPECT_EQ(curves.reversals, 0);
  }
}

/// The table name as part of a test name: gtest allows no dots.
inline std::string testName(std::string table) {
  std::replace(table.begin(), table.end(), '.', 'p');
  return table;
}

}  // namespace lab::system_test
