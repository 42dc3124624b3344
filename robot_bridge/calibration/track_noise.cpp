#include "robot_bridge/calibration/track_noise.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "light/median.hpp"

namespace lab::calibration {
namespace {

// Lower bounds: a tracker without noise still has rounding errors.
constexpr double kLeastPosition = 1e-6;  // [m]
constexpr double kLeastHeading = 1e-5;   // [rad]
constexpr double kTrackedShare = 0.5;
// The residuals of a uniform segment exceed this with probability 1e-8.
constexpr double kUnevenSigmas = 6;

double positionDof(const SegmentMotion& motion) { return 2.0 * motion.points - 4; }
double headingDof(const SegmentMotion& motion) { return motion.points - 2.0; }

/// A robust estimate: up to half of the segments may have any motion.
TrackNoise roughNoise(const std::vector<SegmentMotion>& motions) {
  std::vector<double> positions;
  std::vector<double> headings;
  for (const SegmentMotion& motion : motions) {
    positions.push_back(motion.position_squares / positionDof(motion));
    headings.push_back(motion.heading_squares / headingDof(motion));
  }
  return {std::max(kLeastPosition, std::sqrt(medianOf(positions))),
          std::max(kLeastHeading, std::sqrt(medianOf(headings)))};
}

bool within(double squares, double dof, double sigma) {
  return squares / (sigma * sigma) < dof + kUnevenSigmas * std::sqrt(2 * dof) + kUnevenSigmas;
}

bool isEven(const SegmentMotion& motion, const TrackNoise& noise) {
  return within(motion.position_squares, positionDof(motion), noise.position) &&
         within(motion.heading_squares, headingDof(motion), noise.heading);
}

/// The estimate from all uniform segments together.
TrackNoise pooledNoise(const std::vector<SegmentMotion>& motions, const TrackNoise& rough) {
  double position_squares = 0, position_dof = 0, heading_squares = 0, heading_dof = 0;
  for (const SegmentMotion& motion : motions) {
    if (!isEven(motion, rough)) continue;
    position_squares += motion.position_squares;
    position_dof += positionDof(motion);
    heading_squares += motion.heading_squares;
    heading_dof += headingDof(motion);
  }
  if (position_dof <= 0) return rough;
  return {std::max(kLeastPosition, std::sqrt(position_squares / position_dof)),
          std::max(kLeastHeading, std::sqrt(heading_squares / heading_dof))};
}

}  // namespace

UsableSegments usableSegments(const std::vector<Segment>& segments) {
  UsableSegments result;
  result.counts.driven = static_cast<int>(segments.size());
  std::vector<std::size_t> tracked;
  std::vector<SegmentMotion> motions;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& segment = segments[i];
    const bool enough = static_cast<double>(segment.track.size()) >= kTrackedShare * segment.frames;
    const auto motion = enough ? fitMotion(segment.track, {}) : std::nullopt;
    if (!motion) {
      ++result.counts.unseen;
      continue;
    }
    tracked.push_back(i);
    motions.push_back(*motion);
  }
  if (motions.empty()) return result;

  result.noise = pooledNoise(motions, roughNoise(motions));
  for (const std::size_t i : tracked) {
    const auto motion = fitMotion(segments[i].track, result.noise);
    if (!motion || !isEven(*motion, result.noise)) {
      ++result.counts.uneven;
      continue;
    }
    result.segments.push_back({i, segments[i].duty_left, segments[i].duty_right, *motion});
  }
  result.counts.used = static_cast<int>(result.segments.size());
  return result;
}

}  // namespace lab::calibration
