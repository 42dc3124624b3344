#include "robot_bridge/calibration/motor_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace lab::calibration {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

std::string numbersOf(const Motors& motors, const char* suffix) {
  return fmt::format(
      "gain_left{0} = {1:.6f}\ngain_right{0} = {2:.6f}\ndead_band_left_percent{0} = {3:.4f}\n"
      "dead_band_right_percent{0} = {4:.4f}\nwheel_base_cm{0} = {5:.4f}\n",
      suffix, motors.left.gain, motors.right.gain, 100 * motors.left.dead_band,
      100 * motors.right.dead_band, 100 * motors.wheel_base);
}

std::string checkOf(const SpeedCheck& check, const char* when) {
  if (check.used == 0) return "";
  return fmt::format(
      "{0} = {{speed_error_percent = {1:.3f}, turn_error_percent = {2:.3f}, veer_deg_m = {3:.2f}, "
      "motors_speed_percent = {4:.3f}, motors_turn_percent = {5:.3f}, "
      "tracker_speed_percent = {6:.3f}, tracker_turn_percent = {7:.3f}, parts = {8}, driven = "
      "{9}}}\n",
      when, 100 * check.speed, 100 * check.turn, kDegrees * check.veer, 100 * check.motors_speed,
      100 * check.motors_turn, 100 * check.speed_noise, 100 * check.turn_noise, check.used,
      check.driven);
}

/// A string in TOML's syntax.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') result += '\\';
    result += letter == '\n' ? ' ' : letter;
  }
  return result + "\"";
}

std::string within(double value, double error, double unit, int digits) {
  return fmt::format("{:.{}f}({:.{}f})", value / unit, digits, error / unit, digits);
}

}  // namespace

std::string checkRefusal(const SpeedCheck& after, const CheckLimits& limits) {
  if (after.used < limits.used_share * after.driven) {
    return fmt::format("only {} of {} parts of the check after storing are usable", after.used,
                       after.driven);
  }
  const double speed = std::max(limits.speed, 4 * after.speed_noise);
  const double turn = std::max(limits.turn, 4 * after.turn_noise);
  if (after.motors_speed <= speed && after.motors_turn <= turn) return "";
  return fmt::format(
      "in the check after storing, the speeds are wrong by {:.1f} % (allowed {:.1f}), the turns by "
      "{:.1f} % (allowed {:.1f}): does the floor let the wheels slip?",
      100 * after.motors_speed, 100 * speed, 100 * after.motors_turn, 100 * turn);
}

std::string tableHead() {
  return fmt::format(
      "{:>5}  {:>15} {:>15}  {:>12} {:>12}  {:>13}  {:>13} {:>13} {:>13}\n{:>5}  "
      "{:>15} {:>15}  {:>12} {:>12}  {:>13}  {:>13} {:>13} {:>13}\n",
      "robot", "gain left", "gain right", "dead left", "dead right", "wheel base", "speed error",
      "turn error", "veer", "", "", "", "% of duty", "% of duty", "cm", "before, after",
      "before, after", "deg/m");
}

std::string tableLine(const MotorReport& report) {
  if (!report.refusal.empty()) {
    return fmt::format("{:>5}  not calibrated: {}\n", report.robot, report.refusal);
  }
  const Motors& motors = report.fit.motors;
  const Motors& error = report.fit.error;
  const auto pair = [](double before, double after, double unit, const char* mark) {
    return fmt::format("{:.1f}, {:.2f}{}", before / unit, after / unit, mark);
  };
  return fmt::format("{:>5}  {:>15} {:>15}  {:>12} {:>12}  {:>13}  {:>13} {:>13} {:>13}\n",
                     report.robot, within(motors.left.gain, error.left.gain, 1, 4),
                     within(motors.right.gain, error.right.gain, 1, 4),
                     within(motors.left.dead_band, error.left.dead_band, 0.01, 2),
                     within(motors.right.dead_band, error.right.dead_band, 0.01, 2),
                     within(motors.wheel_base, error.wheel_base, 0.01, 3),
                     pair(report.before.speed, report.after.speed, 0.01, " %"),
                     pair(report.before.turn, report.after.turn, 0.01, " %"),
                     pair(report.before.veer, report.after.veer, 1 / kDegrees, ""));
}

std::string motorsFile(const std::vector<MotorReport>& reports) {
  std::string text =
      "# What the motors of the robots are, as the tracker saw them move (docs/calibration.md).\n"
      "# Keys with _error are standard errors of the fit; the robot holds whole duties of 255.\n"
      "fileversion = 1\n";
  for (const MotorReport& report : reports) {
    if (!report.refusal.empty()) continue;
    const MotorFit& fit = report.fit;
    text += fmt::format("\n[[robots]]\nid = {}\n", report.robot);
    text += numbersOf(report.stored, "") + numbersOf(fit.motors, "_fitted") +
            numbersOf(fit.error, "_error") + numbersOf(report.held, "_before");
    text += fmt::format(
        "tracked_point_left_cm = {:.4f}\ntracked_point_left_cm_error = {:.4f}\n"
        "tracker_noise_cm = {:.4f}\ntracker_noise_deg = {:.3f}\n"
        "chi2_per_dof = {:.3f}\nresidual_percent = {:.3f}\n"
        "parts = {{driven = {}, used = {}, unseen = {}, uneven = {}, outlying = {}}}\n",
        100 * fit.lateral, 100 * fit.lateral_error, 100 * fit.noise.position,
        kDegrees * fit.noise.heading, fit.chi2_per_dof, 100 * fit.residual, fit.segments.driven,
        fit.segments.used, fit.segments.unseen, fit.segments.uneven, fit.segments.outlying);
    text += checkOf(report.before, "check_before") + checkOf(report.after, "check_after");
  }
  for (const MotorReport& report : reports) {
    if (report.refusal.empty()) continue;
    text +=
        fmt::format("\n[[refused]]\nid = {}\nreason = {}\n", report.robot, quoted(report.refusal));
  }
  return text;
}

}  // namespace lab::calibration
