/// A robot on the wire as ROBOT_STATUS and ROBOT_STEPS say it.
#pragma once

#include <lab/robot_state_t.hpp>
#include <lab/robot_step_t.hpp>
#include <optional>

#include "robot_bridge/protocol/robot_link.hpp"

namespace lab::bridge {

/// What of a robot has been reported before.
class ReportHistory {
 public:
  /// Host time of something on the robot's clock. It stays what it was once some seconds have
  /// passed: the clock's rate, fitted anew with each round trip, would move what is long ago.
  class Time {
   public:
    std::int64_t at(const ClockEstimate& clock, std::uint32_t ms, std::uint32_t now_ms);

   private:
    bool known_ = false;
    std::uint32_t ms_ = 0;
    std::int64_t utime_ = 0;
  };

  /// Time in runs in host seconds, which for the same reason only adds up.
  double runTime(double run_time_ms, double rate);

  /// Whether there were saturations since the last call.
  bool saturated(std::uint32_t count);

  Time program_start;
  Time reversal_start;
  Time reversal_end;

 private:
  double run_time_ms_ = 0;
  double run_time_ = 0;
  std::uint32_t saturations_ = 0;
};

/// The last snapshot of a robot, in SI units and host time, exactly as sim_svc would say it;
/// nothing while there is no snapshot.
/// @param origin robot_state_t's
[[nodiscard]] std::optional<robot_state_t> statusOf(const RobotLink& robot, std::int8_t origin,
                                                    ReportHistory& reported);

[[nodiscard]] robot_step_t stepOf(const RobotLink& robot, const RobotView::UnwrappedStep& step);

}  // namespace lab::bridge
