/// Converts a robot's reports into the messages ROBOT_STATUS and ROBOT_STEPS.
#pragma once

#include <cstdint>
#include <lab/robot_state_t.hpp>
#include <lab/robot_step_t.hpp>
#include <optional>

#include "robot_bridge/protocol/robot_link.hpp"

namespace lab::bridge {

/// Previously reported values of a robot, needed to keep later reports consistent.
class ReportHistory {
 public:
  /// Host time of an event on the robot's clock. The time is kept when the event is more than 5 s
  /// old, because each new fit of the clock's rate would move old events.
  class Time {
   public:
    std::int64_t at(const ClockEstimate& clock, std::uint32_t ms, std::uint32_t now_ms);

   private:
    bool known_ = false;
    std::uint32_t ms_ = 0;
    std::int64_t utime_ = 0;
  };

  /// Time in runs in host seconds, accumulated with the rate at each call for the same reason.
  double runTime(double run_time_ms, double rate);

  /// Whether the count of saturations has changed since the last call.
  bool saturated(std::uint32_t count);

  Time program_start;
  Time reversal_start;
  Time reversal_end;

 private:
  double run_time_ms_ = 0;
  double run_time_ = 0;
  std::uint32_t saturations_ = 0;
};

/// The last snapshot of a robot, in SI units and host time, with the same conventions as sim_svc.
/// Empty while there is no snapshot.
/// @param origin as in robot_state_t
[[nodiscard]] std::optional<robot_state_t> statusOf(const RobotLink& robot, std::int8_t origin,
                                                    ReportHistory& reported);

[[nodiscard]] robot_step_t stepOf(const RobotLink& robot, const RobotView::UnwrappedStep& step);

}  // namespace lab::bridge
