/// A recorded robot played back into a live run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <lab/robot_state_t.hpp>
#include <lab/tracked_pose_t.hpp>
#include <optional>
#include <vector>

namespace lab::sim {

/// What a log has of one robot, from some time on.
struct Recording {
  struct Frame {
    std::int64_t utime = 0;  ///< Of the exposure.
    tracked_pose_t pose{};
  };
  std::vector<Frame> frames;          ///< In order of time, each time once; at least two.
  std::vector<robot_state_t> states;  ///< Likewise; may be empty.
  double frame_period = 0;            ///< Nominal, s.
};

/// Reads a log, or the log of a run's folder.
/// @param robot_id of the robot in the log
/// @param from s after the start of the log's light script (without one: after its first frame)
/// @throws std::runtime_error, one line: no such log, no such robot (and which there are), or it
/// ends before there is anything to play
[[nodiscard]] Recording loadRecording(const std::filesystem::path& log, std::int32_t robot_id,
                                      double from);

/// The recording at the same pace, shifted so that its first frame falls on start_utime.
class ReplayRobot {
 public:
  /// @param id of the robot that plays it
  ReplayRobot(Recording recording, std::int32_t id, std::int64_t start_utime);

  [[nodiscard]] std::int32_t id() const { return id_; }

  /// Whether the recording is over; then the robot is gone.
  [[nodiscard]] bool isOver(std::int64_t utime) const { return utime > end_utime_; }

  /// Where it was last seen: for those who may run into it.
  [[nodiscard]] std::optional<tracked_pose_t> lastPose(std::int64_t utime) const;

  /// The pose as tracked at this time: a recorded one, or between two frames that followed each
  /// other the one on the straight line between them. None where the tracker had lost the robot.
  [[nodiscard]] std::optional<tracked_pose_t> trackedPose(std::int64_t utime) const;

  /// The last state before this time: with origin REPLAY, all its times shifted, and no command or
  /// stop obeyed, as it obeys nobody.
  [[nodiscard]] std::optional<robot_state_t> state(std::int64_t utime) const;

 private:
  [[nodiscard]] tracked_pose_t named(tracked_pose_t pose) const;

  Recording recording_;
  std::int32_t id_;
  std::int64_t shift_us_;  ///< Live time minus recorded time.
  std::int64_t end_utime_;
};

}  // namespace lab::sim
