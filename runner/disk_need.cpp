#include "runner/disk_need.hpp"

namespace lab::runner {

std::int64_t diskNeed_bytes(const Experiment& experiment) {
  // Sizes of the encoded messages with LCM's header and channel name, from lcmtypes/README.md.
  constexpr double kMessage = 120;
  constexpr double kPose = 90;
  constexpr double kState = 320;
  constexpr double kTruth = 40;
  constexpr double kLight = 300;
  constexpr double kAnalysis = 8000;
  constexpr double kTrajectoryRow = 90;
  constexpr double kReserve = 100e6;
  const auto robots = static_cast<double>(experiment.robots.size());
  const auto programs = static_cast<double>(experiment.programs.size());
  const double per_second =
      experiment.camera.fps * (kMessage + robots * (kPose + kTrajectoryRow)) +
      experiment.hardware.status_rate * (2 * kMessage + robots * (kState + kTruth)) +
      experiment.light.frame_rate * kLight + (robots + 1) * programs * kAnalysis;
  return static_cast<std::int64_t>(kReserve + experiment.duration * per_second);
}

}  // namespace lab::runner
