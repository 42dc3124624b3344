/// A model of camera and tracker: noise and drop-outs.
#pragma once

#include <cstdint>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/math/random.hpp"
#include "robot/dynamics/kinematics.hpp"

namespace lab::sim {

/// Converts true poses into a TRACKED_FRAME. Every robot has its own noise stream.
class TrackerModel {
 public:
  TrackerModel(const Camera& camera, std::uint64_t seed) : camera_(camera), seed_(seed) {}

  /// Begins the next camera frame. @return false if the camera drops it.
  [[nodiscard]] bool begin(std::int64_t exposure_utime);

  /// Begins a frame that was recorded, without random losses.
  /// @param missing robots that it does not have, rising; must outlive the frame
  void beginRecorded(std::int64_t exposure_utime, const std::vector<std::int32_t>& missing);

  /// Adds one robot with noise, unless the tracker misses it in this frame.
  void observe(std::int32_t robot_id, const dynamics::Pose& truth);

  /// Adds a pose without noise.
  void add(const tracked_pose_t& pose);

  [[nodiscard]] const tracked_frame_t& frame() const { return frame_; }

 private:
  Camera camera_;
  std::uint64_t seed_;
  std::int64_t number_ = 0;
  Random frames_{deriveSeed(seed_, 0, "camera frames")};
  std::map<std::int32_t, Random> robots_;
  const std::vector<std::int32_t>* missing_ = nullptr;  ///< of a recorded frame
  tracked_frame_t frame_{};
};

}  // namespace lab::sim
