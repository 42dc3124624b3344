#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "analyzer/tracks/reversal_finder.hpp"
#include "tests/analyzer/recording_ensemble.hpp"
#include "tests/analyzer/walker.hpp"

namespace lab::analysis {

/// A recording without telemetry.
struct PoseRecording {
  std::vector<TrackPoint> track;
  std::vector<FoundReversal> truth;
};

inline PoseRecording posesOf(const WalkerRecording& recording) {
  PoseRecording result;
  Walker walker(recording);
  walker.on_frame = [&](const TrackPoint& point) {
    result.track.push_back(point);
    result.track.back().sigma = 0;  // not in a CSV file
    result.track.back().sigma_theta = 0;
  };
  walker.on_telemetry = [&](const RobotTelemetry& told) {
    const auto count = static_cast<std::size_t>(told.reversal_count);
    if (count > result.truth.size()) result.truth.resize(count);
    if (count > 0 && !told.reversing) {
      result.truth[count - 1].start = told.reversal_start;
      result.truth[count - 1].end = told.reversal_end;
    }
  };
  walker.run();
  return result;
}

/// The samples after stitching by poses alone.
inline StitchedRecording stitchPoses(const WalkerRecording& recording,
                                     std::vector<TrackPoint> track,
                                     TrackFindings* findings = nullptr) {
  StitchedRecording result;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TrackFindings found =
      examineTrack(track, reversalSearch(recording.law, recording.walls ? nan : 0.1, 0.4));
  if (findings != nullptr) *findings = found;
  TrackStitcher stitcher{StitcherConfig{}};
  ReversalReporter reporter(found.reversals);
  for (const TrackPoint& point : track) {
    RobotTelemetry telemetry;
    telemetry.time = point.time;
    telemetry.program = 0;
    telemetry.sense_distance = senseDistance(recording.law);
    reporter.report(telemetry);
    telemetry.run_time = point.time - reporter.removed();
    stitcher.addTelemetry(telemetry, result.samples);
    stitcher.addFrame(point, result.samples);
  }
  stitcher.flush(result.samples);
  result.counters = stitcher.counters();
  result.tally = stitcher.tally(0);
  return result;
}

/// The exact law plus the contribution of the tracker noise; for the angular MSD that of the
/// heading noise.
inline double withNoise(const WalkerRecording& recording, double exact, bool angular) {
  return exact + (angular ? 2 * recording.sigma_theta * recording.sigma_theta
                          : 4 * recording.sigma * recording.sigma);
}

inline void expectUnbiasedWithNoise(const WalkerRecording& recording, const EnsembleCurves& curves,
                                    double recordings) {
  for (const bool angular : {false, true}) {
    for (const LagScatter& lag : angular ? curves.angular : curves.msd) {
      if (lag.value.n != recordings) continue;
      const double expected = withNoise(recording, lag.exact, angular);
      EXPECT_LT(std::abs(lag.value.z(expected)), 4)
          << (angular ? "angular MSD" : "MSD") << " at " << lag.tau
          << " s: " << lag.value.mean() / expected;
    }
  }
}

}  // namespace lab::analysis
