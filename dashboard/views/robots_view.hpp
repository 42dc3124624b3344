/// The robots: where they are, and what they say about themselves.
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

/// One robot as it was heard and seen last. Times are us since 1970.
struct RobotRow {
  robot_state_t state{};
  std::string owner;  ///< sender of its status, empty: nothing was heard of it
  std::int64_t heard_utime = 0;
  std::string rival;  ///< another sender of the same robot
  std::int64_t rival_utime = 0;
  int program = -1;  ///< as RunInfo::indexOf()

  tracked_pose_t pose{};
  std::int8_t pose_origin = 0;
  std::int64_t seen_utime = 0;  ///< 0: never

  std::int32_t errors_before = 0;  ///< link_errors at the beginning of ...
  std::int64_t errors_utime = 0;   ///< ... the running span of 10 s
  std::int32_t new_errors = 0;     ///< in the span before

  [[nodiscard]] std::int8_t origin() const { return owner.empty() ? pose_origin : state.origin; }
  [[nodiscard]] bool batteryIsLow() const;
};

class RobotsView {
 public:
  static constexpr std::size_t kMostRobots = 500;

  explicit RobotsView(const RunInfo& run_info) : run_info_(run_info) {}

  void take(const robot_status_t& status, std::int64_t now);
  void take(const tracked_frame_t& frame, std::int64_t now);

  /// Another run, or another part of it.
  void clear();

  /// The programs of the experiment are others.
  void renumber();

  /// Of topic `frame`; a robot that has not been seen for a second is left out.
  [[nodiscard]] std::string frameJson(std::int64_t now) const;

  /// Of topic `robots`.
  [[nodiscard]] std::string robotsJson(std::int64_t now) const;

  /// Of `robot`: all that one robot says; nothing: there is none of that id.
  [[nodiscard]] std::optional<std::string> robotJson(std::int32_t id, std::int64_t now) const;

  [[nodiscard]] const std::map<std::int32_t, RobotRow>& rows() const { return rows_; }

  /// Robots that were left out because there are too many.
  [[nodiscard]] std::int64_t leftOut() const { return left_out_; }

  /// Counts frames that were taken.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }

 private:
  RobotRow* rowOf(std::int32_t id);
  [[nodiscard]] std::string nameOf(const RobotRow& row) const;

  const RunInfo& run_info_;
  std::map<std::int32_t, RobotRow> rows_;
  std::vector<tracked_pose_t> unidentified_;
  std::int64_t unidentified_utime_ = 0;  ///< when they were seen
  std::int64_t frame_utime_ = 0;         ///< of the newest frame
  std::int64_t left_out_ = 0;
  std::uint64_t frames_ = 0;
};

}  // namespace lab::dashboard
