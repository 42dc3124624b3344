/// The experiment file for a restarted sim_svc.
#pragma once

#include <cstdint>
#include <lab/tracked_pose_t.hpp>
#include <map>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// The experiment with the robots where the tracker last saw them, and with a new seed, so that no
/// random number is drawn twice.
///
/// By the noise of the tracker, robots in contact may overlap each other or a wall. They are moved
/// apart by that much. A robot that still has no room, or that was never seen, is placed at random.
/// @param restart 1 for the first restart
[[nodiscard]] Experiment resumedExperiment(const Experiment& experiment,
                                           const std::map<std::int32_t, tracked_pose_t>& seen,
                                           int restart);

}  // namespace lab::runner
