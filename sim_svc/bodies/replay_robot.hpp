/// Playback of a recorded robot in a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <lab/robot_state_t.hpp>
#include <lab/tracked_pose_t.hpp>
#include <optional>
#include <vector>

namespace lab::sim {

/// The messages about one robot in a log, from some time on.
struct Recording {
  struct Frame {
    std::int64_t utime = 0;  ///< Time of the exposure.
    tracked_pose_t pose{};
  };
  std::vector<Frame> frames;          ///< In order of time, no duplicates; at least two.
  std::vector<robot_state_t> states;  ///< In order of time, no duplicates; may be empty.
  double frame_period = 0;            ///< Nominal [s].
};

/// Reads a log, or the log in the folder of a run.
/// @param robot_id of the robot in the log
/// @param from [s] after the start of the log's light script (without one: after its first frame)
/// @throws std::runtime_error (one line) if there is no such log or no such robot, or if the
///   robot's frames end before `from`
[[nodiscard]] Recording loadRecording(const std::filesystem::path& log, std::int32_t robot_id,
                                      double from);

/// The recording at its original pace, shifted so that its first frame is at start_utime.
class ReplayRobot {
 public:
  /// @param id of the robot in this run
  ReplayRobot(Recording recording, std::int32_t id, std::int64_t start_utime);

  [[nodiscard]] std::int32_t id() const { return id_; }

  /// Whether the recording is over; then the robot is gone.
  [[nodiscard]] bool isOver(std::int64_t utime) const { return utime > end_utime_; }

  /// The last recorded pose, for collisions.
  [[nodiscard]] std::optional<tracked_pose_t> lastPose(std::int64_t utime) const;

  /// The tracked pose at this time, linearly interpolated between consecutive frames. Empty if the
  /// tracker had lost the robot.
  [[nodiscard]] std::optional<tracked_pose_t> trackedPose(std::int64_t utime) const;

  /// The last state before this time, with origin REPLAY and shifted times, and without command and
  /// stop numbers because it follows no commands.
  [[nodiscard]] std::optional<robot_state_t> state(std::int64_t utime) const;

 private:
  [[nodiscard]] tracked_pose_t named(tracked_pose_t pose) const;

  Recording recording_;
  std::int32_t id_;
  std::int64_t shift_us_;  ///< Live time minus recorded time.
  std::int64_t end_utime_;
};

}  // namespace lab::sim
