/// Calibrates the motors of the robots of a lab, one after the other.
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

/// Asks what the robots hold; then each drives the check, drives the pattern, is fitted, stores the
/// outcome and drives the check again. What does not pass is not stored, or is taken back.
///
/// Only the tracker's poses tell how a robot moves.
class MotorCalibrator final : public Service {
 public:
  /// @param robots which, in this order
  /// @param tell called with each outcome
  /// @param done called when all is done
  MotorCalibrator(const ServiceContext& context, ExperimentController& controller,
                  std::vector<std::int32_t> robots,
                  std::function<void(const calibration::MotorReport&)> tell,
                  std::function<void()> done);

 private:
  enum class Phase { kBoot, kAsk, kCheckBefore, kPattern, kStore, kCheckAfter, kTakeBack, kDone };

  void take(const robot_calibration_t& status);
  void tick();
  void ask();
  void nextRobot();
  void drive(Phase phase, const calibration::Pattern& pattern, const calibration::Motors& believed);
  void startPattern();
  void driven();
  void fit(const std::vector<calibration::CheckedSegment>& driven);
  void store(Phase phase, const calibration::Motors& motors);
  void stored();
  void giveUpStoring();
  void refuse(const std::string& why);
  void finishRobot();
  void request(const std::vector<motor_calibration_t>& motors);
  void command(double left, double right);
  [[nodiscard]] bool isHeld(const calibration::Motors& motors) const;
  [[nodiscard]] std::int64_t patience() const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  ExperimentController& controller_;
  std::vector<std::int32_t> robots_;
  std::function<void(const calibration::MotorReport&)> tell_;
  std::function<void()> done_;

  Phase phase_ = Phase::kBoot;
  std::int64_t since_ = 0;  ///< utime of the phase's begin
  std::size_t next_robot_ = 0;
  calibration::MotorReport report_;
  std::unique_ptr<PatternDriver> driver_;
  calibration::Pattern pattern_;                     ///< that it drives
  calibration::Motors believed_;                     ///< by the robot meanwhile
  int tries_ = 0;                                    ///< at this pattern
  std::vector<calibration::CheckedSegment> before_;  ///< the check before
  SeenRobots seen_robots_;
  std::map<std::int32_t, calibration::Motors> held_;  ///< as their owners say
  robot_calibration_t request_{};
  std::int64_t next_request_ = 0;  ///< utime
};

}  // namespace lab::runner
