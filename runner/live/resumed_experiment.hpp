/// What a restarted sim_svc begins with.
#pragma once

#include <cstdint>
#include <lab/tracked_pose_t.hpp>
#include <map>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// The experiment with the robots where the tracker last saw them, and with a seed of its own, so
/// that no random number is drawn twice.
///
/// Robots in contact seem to overlap by the tracker's noise, or to stand in a wall: they are moved
/// apart by as much. A robot for which there is no room that way, or that was never seen, is placed
/// at random.
/// @param restart 1 for the first.
[[nodiscard]] Experiment resumedExperiment(const Experiment& experiment,
                                           const std::map<std::int32_t, tracked_pose_t>& seen,
                                           int restart);

}  // namespace lab::runner
