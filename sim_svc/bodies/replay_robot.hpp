/// Playback of a recorded robot in a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <lab/robot_state_t.hpp>
#include <lab/tracked_pose_t.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
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

/// What a log has about some robots. A log may have gigabytes: it is read once for all of them.
class RecordedLog {
 public:
  /// Reads a log, or the log in the folder of a run.
  /// @param robot_ids ids in the log, one for each call of take() that follows
  /// @throws std::runtime_error (one line) if there is no such log
  RecordedLog(const std::filesystem::path& path, const std::vector<std::int32_t>& robot_ids);

  /// @param robot_id of the robot in the log
  /// @param from [s] after the start of the log's light script; without one, after the robot's
  ///   first frame
  /// @throws std::runtime_error (one line) if there is no such robot, or if its frames end before
  ///   `from`
  [[nodiscard]] Recording take(std::int32_t robot_id, double from);

 private:
  struct Robot {
    Recording recording;
    std::size_t uses = 0;  ///< calls of take() that follow
  };

  std::string name_;
  std::map<std::int32_t, Robot> robots_;
  std::set<std::int32_t> seen_;    ///< ids of all robots in its camera frames
  std::int64_t script_start_ = 0;  ///< [us since 1970] 0: it has no script
};

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
