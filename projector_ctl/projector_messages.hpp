/// What the projector hears and says, as messages.
#pragma once

#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/tracked_frame_t.hpp>

#include "common/experiment/experiment.hpp"
#include "light/field/image.hpp"
#include "projector_ctl/projector_core.hpp"
#include "projector_ctl/replay.hpp"

namespace lab::projector {

/// The experiment as scenes know it.
/// @param images of its light script
[[nodiscard]] SceneContext sceneContextOf(const Experiment& experiment, light::ImageStore images);

/// A command without a from_utime begins when it was sent. A program that a gate asks for gets the
/// name under which robots report it: where two names mean the same program, the first.
[[nodiscard]] LightCommand toCommand(const light_command_t& message, const Experiment& experiment,
                                     const light::ImageStore& images);

/// The identified robots of a frame; of a covariance the larger of xx and yy counts.
[[nodiscard]] ObservedFrame toObservedFrame(const tracked_frame_t& message);

[[nodiscard]] ShownRecord toShownRecord(const light_status_t& message);

}  // namespace lab::projector
