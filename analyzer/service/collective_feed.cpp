#include "analyzer/service/collective_feed.hpp"

#include <cmath>

#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

// Poses with a lower confidence are not used, as for single robots.
constexpr float kLeastPoseConfidence = 0.5F;
// A robot that has been silent for longer runs no known program.
constexpr std::int64_t kSilence_us = 2'000'000;

}  // namespace

collective::CrowdConfig crowdConfig(const Experiment& experiment) {
  collective::CrowdConfig config;
  config.settings.arena = {0, 0, experiment.arena_width, experiment.arena_height};
  config.settings.diameter = experiment.hardware.diameter;
  config.settings.cluster_distance = experiment.analysis.cluster_distance;
  config.settings.max_lag = experiment.analysis.max_lag;
  for (const RegionSpec& region : experiment.analysis.regions) {
    config.regions.push_back({region.name, region.shape == Region::kCircle, region.x, region.y,
                              region.radius, region.width, region.height});
  }
  for (const LightBand& band : experiment.light_table.bands) config.bands.push_back(band.program);
  return config;
}

CollectiveFeed::CollectiveFeed(const Experiment& experiment)
    : analysis_(crowdConfig(experiment)),
      bands_(static_cast<int>(experiment.light_table.bands.size())) {}

void CollectiveFeed::take(const robot_status_t& status) {
  for (const robot_state_t& state : status.robots) {
    if (reported_.size() >= collective::CrowdAnalysis::kMostRobots &&
        !reported_.contains(state.robot_id)) {
      continue;
    }
    // The row after the last one stands for light outside of all bands.
    const bool in_band = state.band >= 0 && state.band < bands_;
    reported_[state.robot_id] = {keys_.key(state.program), in_band ? state.band : bands_,
                                 status.utime};
  }
}

void CollectiveFeed::take(const tracked_frame_t& frame) {
  if (origin_utime_ == 0) origin_utime_ = frame.utime;
  poses_.clear();
  for (const tracked_pose_t& pose : frame.robots) {
    if (pose.confidence < kLeastPoseConfidence) continue;
    const auto reported = reported_.find(pose.robot_id);
    const bool known =
        reported != reported_.end() && frame.utime - reported->second.utime < kSilence_us;
    poses_.push_back({pose.robot_id, pose.x, pose.y, pose.theta,
                      known ? reported->second.program : -1, known ? reported->second.band : -1});
  }
  analysis_.addFrame(seconds(frame.utime), frame.frame_period, poses_);
}

program_id_t CollectiveFeed::programOf(int group) const {
  const auto index = static_cast<std::size_t>(group);
  if (group < 0 || index >= keys_.programs().size()) return {};
  return keys_.programs()[index];
}

std::int64_t CollectiveFeed::pictureUtime() const {
  if (analysis_.picture().robots.empty()) return 0;
  return origin_utime_ + units::microseconds(analysis_.picture().time);
}

double CollectiveFeed::seconds(std::int64_t utime) const {
  return units::seconds(utime - origin_utime_);
}

}  // namespace lab::analysis
