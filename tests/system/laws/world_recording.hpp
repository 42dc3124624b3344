/// Records a simulated robot as the tracker and the telemetry would.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "analyzer/tracks/track_stitcher.hpp"
#include "common/math/random.hpp"
#include "robot/dynamics/robot_core.hpp"
#include "sim_svc/world.hpp"

namespace lab::system_test {

struct RecordingSettings {
  double fps = 50;
  double status_rate = 50;    ///< [1/s] rate of the telemetry
  double position_noise = 0;  ///< [m] of the tracker, per axis
  double heading_noise = 0;   ///< [rad] of the tracker
  std::int64_t start_us = 0;  ///< world time of the first frame and telemetry [us]
  std::uint64_t noise_seed = 0;
};

/// Records the first robot of a world with the contents and times that sim_svc would put into its
/// messages. Calls `on_frame` with each TrackPoint and `on_telemetry` with each RobotTelemetry,
/// whose program is the slot in the light table (-1: none). Times are world times.
class WorldRecording {
 public:
  WorldRecording(sim::World& world, const RecordingSettings& settings)
      : world_(world), settings_(settings), noise_(settings.noise_seed) {}

  /// Records up to and including the given world time.
  template <class OnFrame, class OnTelemetry>
  void recordUntil(std::int64_t end_us, OnFrame on_frame, OnTelemetry on_telemetry) {
    for (;;) {
      const std::int64_t frame_us = sampleTime(frames_, settings_.fps);
      const std::int64_t status_us = sampleTime(reports_, settings_.status_rate);
      const bool frame_first = frame_us <= status_us;
      const std::int64_t next_us = frame_first ? frame_us : status_us;
      if (next_us > end_us) {
        world_.advanceTo(end_us);
        return;
      }
      world_.advanceTo(next_us);
      if (frame_first) {
        on_frame(frame());
        ++frames_;
      } else {
        on_telemetry(telemetry());
        ++reports_;
      }
    }
  }

 private:
  [[nodiscard]] std::int64_t sampleTime(std::int64_t number, double rate) const {
    return settings_.start_us +
           static_cast<std::int64_t>(std::llround(static_cast<double>(number) * 1e6 / rate));
  }

  /// Messages have a resolution of 1 us.
  static double whole(double seconds) { return std::round(seconds * 1e6) * 1e-6; }

  analysis::TrackPoint frame() {
    const dynamics::Pose pose = world_.pose(0);
    analysis::TrackPoint point;
    point.time = world_.time();
    point.frame = frames_;
    point.x = pose.x;
    point.y = pose.y;
    point.theta = pose.theta;
    point.sigma = settings_.position_noise;
    point.sigma_theta = settings_.heading_noise;
    if (settings_.position_noise > 0) {
      point.x += settings_.position_noise * noise_.normal();
      point.y += settings_.position_noise * noise_.normal();
      point.theta += settings_.heading_noise * noise_.normal();
    }
    point.theta = std::remainder(point.theta, 2 * std::numbers::pi);
    return point;
  }

  analysis::RobotTelemetry telemetry() {
    const sim::RobotState state = world_.state(0);
    const auto has = [&state](dynamics::CoreFlag flag) { return (state.core.flags & flag) != 0; };
    analysis::RobotTelemetry message;
    message.time = world_.time();
    message.program = state.core.slot < dynamics::kSlots ? state.core.slot : -1;
    message.program_epoch = state.core.program_epoch;
    message.program_start = whole(state.program_start);
    message.reversal_count = state.core.reversal_count;
    message.reversing = has(dynamics::kReversing);
    message.reversal_start = whole(state.reversal_start);
    message.reversal_end = message.reversing ? 0 : whole(state.reversal_end);
    message.v_l = state.program_left;
    message.v_r = state.program_right;
    const std::int64_t contacts = state.robot_contacts + state.wall_contacts;
    message.contact = state.contact_robot || state.contact_wall || contacts != contacts_;
    contacts_ = contacts;
    message.stopped = has(dynamics::kStopped) || has(dynamics::kLeaseExpired);
    message.tumble_count = state.core.tumble_count;
    message.run_time = state.run_time / world_.clock(0).rate();
    return message;
  }

  sim::World& world_;
  RecordingSettings settings_;
  Random noise_;
  std::int64_t frames_ = 0;
  std::int64_t reports_ = 0;
  std::int64_t contacts_ = 0;
};

}  // namespace lab::system_test
