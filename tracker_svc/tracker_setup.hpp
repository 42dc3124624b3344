/// What the services with one and with several cameras take from an experiment, and their messages.
#pragma once

#include <cstdint>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "common/service/service_main.hpp"
#include "tracker_svc/marker_detector.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"

namespace lab::tracker {

/// The calibration of the camera's file, or that of the simulated camera.
/// @throws ExperimentError if the file cannot be read or is for another picture size
[[nodiscard]] CameraCalibration calibrationInForce(const ServiceContext& context,
                                                   const Camera& camera);

[[nodiscard]] optics::Imaging imagingOf(const CameraCalibration& calibration);

/// The robots under the camera: a real camera sees only real robots.
[[nodiscard]] std::vector<std::int32_t> robotsInView(const Experiment& experiment);

[[nodiscard]] detector::MarkerSettings markersOf(const Experiment& experiment);

[[nodiscard]] TrackerSettings trackerSettings(const Experiment& experiment);

/// As in robot_state_t.
[[nodiscard]] std::int8_t originOf(const Camera& camera);

/// Adds the detected tracks: first the identified ones by robot, then the others by track.
void addTracks(const std::vector<Track>& tracks, tracked_frame_t& frame,
               tracked_details_t& details);

}  // namespace lab::tracker
