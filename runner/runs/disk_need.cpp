#include "runner/runs/disk_need.hpp"

#include "common/experiment/experiment_log_size.hpp"

namespace lab::runner {

std::int64_t diskNeed_bytes(const Experiment& experiment) {
  constexpr double kTrajectoryRow = 90;
  constexpr double kReserve = 100e6;
  const double rows =
      static_cast<double>(experiment.robots.size()) * experiment.camera.fps * experiment.duration;
  return static_cast<std::int64_t>(kReserve + static_cast<double>(expectedLogBytes(experiment)) +
                                   rows * kTrajectoryRow);
}

}  // namespace lab::runner
