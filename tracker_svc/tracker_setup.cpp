#include "tracker_svc/tracker_setup.hpp"

#include <algorithm>
#include <lab/cap_detail_t.hpp>
#include <lab/robot_state_t.hpp>

#include "light/optics/simulated_camera.hpp"
#include "tracker_svc/camera_devices.hpp"

namespace lab::tracker {
namespace {

constexpr double kWhite = 255;  // [DN]

tracked_pose_t toPose(const Track& track) {
  tracked_pose_t pose{};
  pose.robot_id = track.robot_id;
  pose.x = track.pose.x;
  pose.y = track.pose.y;
  pose.theta = track.pose.theta;
  std::copy(track.pose.covariance.begin(), track.pose.covariance.end(), pose.covariance);
  pose.confidence = track.pose.quality;
  return pose;
}

cap_detail_t toDetail(const Track& track) {
  cap_detail_t detail{};
  detail.robot_id = track.robot_id;
  detail.track = track.number;
  detail.used = static_cast<std::int8_t>(track.pose.used);
  detail.spacing = track.pose.spacing;
  detail.white = track.pose.white / static_cast<float>(kWhite);
  detail.u = static_cast<float>(track.pose.middle.x);
  detail.v = static_cast<float>(track.pose.middle.y);
  return detail;
}

}  // namespace

CameraCalibration calibrationInForce(const ServiceContext& context, const Camera& camera) {
  const Experiment& experiment = context.experiment;
  if (!camera.calibration.empty()) return readCameraFile(context.directory / camera.calibration);
  CameraCalibration calibration;
  const CameraView& view = camera.view;
  calibration.camera =
      optics::simulatedCameraAbove(camera.width, camera.height, view.x, view.y,
                                   view.width > 0 ? view.width : experiment.arena_width,
                                   view.height > 0 ? view.height : experiment.arena_height);
  calibration.arena_width = experiment.arena_width;
  calibration.arena_height = experiment.arena_height;
  calibration.id = "simulated";
  calibration.imaging = optics::Imaging{.gamma = 1};
  return calibration;
}

optics::Imaging imagingOf(const CameraCalibration& calibration) {
  return calibration.imaging.value_or(optics::Imaging{});
}

std::vector<std::int32_t> robotsInView(const Experiment& experiment) {
  const bool painted = isPainted(experiment.camera);
  std::vector<std::int32_t> ids;
  for (const RobotSpec& robot : experiment.robots) {
    if ((robot.body == Body::kSerial) != painted) ids.push_back(robot.id);
  }
  return ids;
}

detector::MarkerSettings markersOf(const Experiment& experiment) {
  const Camera& camera = experiment.camera;
  detector::MarkerSettings markers;
  markers.blobs = {.bright = camera.blob == BlobTone::kBright,
                   .smallest = camera.blob_smallest,
                   .largest = camera.blob_largest,
                   .height = camera.marker_height,
                   .arena_width = experiment.arena_width,
                   .arena_height = experiment.arena_height};
  markers.tags = {.family = entryOf(camera.tag_family).name,
                  .size = camera.tag_size,
                  .height = camera.marker_height};
  if (camera.marker == Marker::kBlobs) markers.kind = detector::MarkerKind::kBlobs;
  if (camera.marker == Marker::kTags) markers.kind = detector::MarkerKind::kTags;
  return markers;
}

TrackerSettings trackerSettings(const Experiment& experiment) {
  TrackerSettings settings;
  settings.wheel_base = experiment.hardware.diameter;
  settings.max_wheel_speed = experiment.hardware.max_wheel_speed;
  settings.arena_width = experiment.arena_width;
  settings.arena_height = experiment.arena_height;
  settings.robot_radius = experiment.hardware.diameter / 2;
  return settings;
}

std::int8_t originOf(const Camera& camera) {
  if (isPainted(camera)) return robot_state_t::SIM;
  return isFilm(camera.source) ? robot_state_t::REPLAY : robot_state_t::REAL;
}

void addTracks(const std::vector<Track>& tracks, tracked_frame_t& frame,
               tracked_details_t& details) {
  std::vector<const Track*> detected;
  for (const Track& track : tracks) {
    if (track.detected) detected.push_back(&track);
  }
  std::ranges::stable_sort(detected, [](const Track* a, const Track* b) {
    const bool bound_a = a->robot_id >= 0;
    const bool bound_b = b->robot_id >= 0;
    if (bound_a != bound_b) return bound_a;
    return bound_a ? a->robot_id < b->robot_id : a->number < b->number;
  });
  for (const Track* track : detected) {
    (track->robot_id >= 0 ? frame.robots : frame.unidentified).push_back(toPose(*track));
    details.caps.push_back(toDetail(*track));
  }
  frame.num_robots = static_cast<std::int32_t>(frame.robots.size());
  frame.num_unidentified = static_cast<std::int32_t>(frame.unidentified.size());
  details.num_caps = static_cast<std::int32_t>(details.caps.size());
}

}  // namespace lab::tracker
