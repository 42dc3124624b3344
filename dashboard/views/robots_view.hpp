/// Poses of the robots and the states that they report, as JSON for the page (docs/dashboard.md;
/// dashboard/page/ reads it).
#pragma once

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dashboard/views/run_info.hpp"

namespace lab::dashboard {

/// The newest state and pose of one robot. Times are times of reception, us since 1970.
struct RobotRow {
  robot_state_t state{};
  std::string sender;             ///< of the state; empty if none was received
  std::int64_t status_utime = 0;  ///< when the state was received
  std::string other_sender;       ///< another service that reports the same robot
  std::int64_t other_sender_utime = 0;
  int program = -1;  ///< from RunInfo::indexOf()

  tracked_pose_t pose{};
  std::int8_t pose_origin = 0;
  std::int64_t pose_utime = 0;  ///< when the pose was received; 0: never

  // Errors of the serial line are counted in intervals of 10 s.
  std::int64_t interval_utime = 0;   ///< begin of the current interval
  std::int32_t interval_errors = 0;  ///< link_errors at that time
  std::int32_t recent_errors = 0;    ///< errors in the interval before

  /// As the robot reports it; until it reports, as the tracker says.
  [[nodiscard]] std::int8_t origin() const { return sender.empty() ? pose_origin : state.origin; }
  [[nodiscard]] bool batteryIsLow() const;
};

class RobotsView {
 public:
  /// Twice the 250 robots of an experiment: other programs on the bus may publish robots too.
  static constexpr std::size_t kMaxRobots = 500;

  explicit RobotsView(const RunInfo& run_info) : run_info_(run_info) {}

  void take(const robot_status_t& status, std::int64_t now);
  void take(const tracked_frame_t& frame, std::int64_t now);

  /// Forgets all robots: another run begins, or a replayed log jumps.
  void clear();

  /// Updates the rows' program indices after the experiment has changed.
  void updateProgramIndices();

  /// JSON of topic `frame`. Robots that were not detected for a second are omitted.
  [[nodiscard]] std::string frameJson(std::int64_t now) const;

  /// JSON of topic `robots`.
  [[nodiscard]] std::string robotsJson(std::int64_t now) const;

  /// The response to the query `robot`: everything one robot reports; nothing if it is unknown.
  [[nodiscard]] std::optional<std::string> robotJson(std::int32_t id, std::int64_t now) const;

  [[nodiscard]] const std::map<std::int32_t, RobotRow>& rows() const { return rows_; }

  /// The number of poses and states that were dropped because there are too many robots.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

  /// The number of frames received; changes with every frame.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }

 private:
  RobotRow* rowOf(std::int32_t id);
  [[nodiscard]] std::string nameOf(const RobotRow& row) const;
  /// The name of the program's phase; empty if the program is not known.
  [[nodiscard]] std::string phaseOf(const RobotRow& row) const;

  const RunInfo& run_info_;
  std::map<std::int32_t, RobotRow> rows_;
  std::vector<tracked_pose_t> unidentified_;
  std::int64_t unidentified_utime_ = 0;  ///< when they were received
  std::int64_t frame_utime_ = 0;         ///< of the newest frame
  std::int64_t dropped_ = 0;
  std::uint64_t frames_ = 0;
};

}  // namespace lab::dashboard
