/// Calibrates the motors of the robots, one after the other.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/robot_calibration_t.hpp>
#include <lab/robot_status_t.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "robot_bridge/calibration/motor_report.hpp"
#include "runner/calibrate/pattern_driver.hpp"
#include "runner/live/procedure.hpp"

namespace lab::runner {

/// Requests the stored calibrations of all robots. Then each robot drives the check, drives the
/// pattern, stores the fit and drives the check again. If the second check fails, the previous
/// calibration is stored again.
///
/// The motion is measured only by the poses of the tracker.
class MotorCalibrator final : public Service {
 public:
  /// @param robots ids, in the order of calibration
  /// @param tell called with the report of each robot
  /// @param done called at the end
  MotorCalibrator(const ServiceContext& context, ExperimentController& controller,
                  std::vector<std::int32_t> robots,
                  std::function<void(const calibration::MotorReport&)> tell,
                  std::function<void()> done);

 private:
  enum class Phase { kBoot, kAsk, kCheckBefore, kPattern, kStore, kCheckAfter, kTakeBack, kDone };

  void take(const robot_calibration_t& status);
  void tick();
  void requestStored();
  void nextRobot();
  void drive(Phase phase, const calibration::Pattern& pattern, const calibration::Motors& believed);
  void startPattern();
  void finishPattern();
  void fit(const std::vector<calibration::CheckedSegment>& driven);
  void store(Phase phase, const calibration::Motors& motors);
  void stored();
  void failStoring();
  void refuse(const std::string& why);
  void finishRobot();
  void request(const std::vector<motor_calibration_t>& motors);
  void command(double left, double right);
  [[nodiscard]] bool isHeld(const calibration::Motors& motors) const;
  [[nodiscard]] std::int64_t timeout() const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  ExperimentController& controller_;
  std::vector<std::int32_t> robots_;
  std::function<void(const calibration::MotorReport&)> tell_;
  std::function<void()> done_;

  Phase phase_ = Phase::kBoot;
  std::int64_t since_ = 0;  ///< utime of the beginning of the phase
  std::size_t next_robot_ = 0;
  calibration::MotorReport report_;
  std::unique_ptr<PatternDriver> driver_;
  calibration::Pattern pattern_;                     ///< pattern being driven
  calibration::Motors believed_;                     ///< calibration that the robot uses meanwhile
  int tries_ = 0;                                    ///< attempts at this pattern
  std::vector<calibration::CheckedSegment> before_;  ///< segments of the first check
  SeenRobots seen_robots_;
  std::map<std::int32_t, calibration::Motors>
      held_;  ///< stored calibrations, as CALIBRATION_STATUS reports
  robot_calibration_t request_{};
  std::int64_t next_request_ = 0;  ///< utime
};

}  // namespace lab::runner
