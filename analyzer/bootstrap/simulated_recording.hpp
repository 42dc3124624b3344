#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/laws.hpp"
#include "analyzer/laws/random.hpp"

namespace lab::analysis {

/// A recording of the free process of a program (see ExactLaw), without walls, by a camera.
struct RecordingPlan {
  ProgramLaw law;          ///< Must have a law.
  double duration = 0;     ///< s.
  double period = 0;       ///< Frame period, s.
  double sigma = 0;        ///< Tracker noise per axis, m.
  double sigma_theta = 0;  ///< rad.
  /// s; a frame has the mean pose over it (two-point Gauss rule, exact to third order). Holds count
  /// from the middle of the exposure.
  double exposure = 0;
};

/// The poses of a recording, one per frame; headings are unwrapped. SI units.
struct RecordingPoses {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> theta;
};

/// Simulates the frames of a recording: exact arcs between events, stationary from the first frame
/// on, with a uniformly random observation phase. The same plan and seed give the same bits. Throws
/// std::invalid_argument for a program without a law, or a duration or period that is not positive.
void simulateRecording(const RecordingPlan& plan, std::uint64_t seed, RecordingPoses& poses);

}  // namespace lab::analysis
