/// Converts between the projector's types and messages.
#pragma once

#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/tracked_frame_t.hpp>

#include "common/experiment/experiment.hpp"
#include "light/field/image.hpp"
#include "projector_ctl/projector_core.hpp"
#include "projector_ctl/replay.hpp"

namespace lab::projector {

/// The properties of an experiment that scenes need.
/// @param images of its light script
[[nodiscard]] SceneContext sceneContextOf(const Experiment& experiment, light::ImageStore images);

/// A command without a from_utime begins when it was sent. Gates refer to programs by the name
/// under which robots report them, which is the first name if two names mean the same program. Of a
/// long label only the beginning is kept.
[[nodiscard]] LightCommand toCommand(const light_command_t& message, const Experiment& experiment,
                                     const light::ImageStore& images);

/// The identified robots of a frame. The variance is the larger one of xx and yy.
[[nodiscard]] ObservedFrame toObservedFrame(const tracked_frame_t& message);

[[nodiscard]] ShownRecord toShownRecord(const light_status_t& message);

}  // namespace lab::projector
