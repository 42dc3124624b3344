#include "robot/dynamics/robot_program.hpp"

#include <cmath>
#include <cstdio>

#include "robot/dynamics/exponential.hpp"

namespace lab {
namespace dynamics {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLongestTime = 3600.0;  // s, for epsilon and tau_t
constexpr double kRoundingSlack = 1e-9;  // so that a limit met exactly is not refused

std::string text(const char* format, double first, double second = 0) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, first, second);
  return buffer;
}

int32_t microPerSecond(double metre_per_second) {
  return static_cast<int32_t>(std::lround(metre_per_second * 1e6));
}

uint32_t milliseconds(double seconds) { return static_cast<uint32_t>(std::lround(seconds * 1e3)); }

// One reason, or empty. `name` carries the quantity and its unit, e.g. "eta (rad/s)".
std::string checkNotNegative(const char* name, double value) {
  if (!std::isfinite(value)) {
    return std::string(name) + " is not a finite number";
  }
  return value < 0 ? std::string(name) + text(" is negative: found %g, allowed 0 or more", value)
                   : std::string();
}

std::string checkFinite(const char* name, double value) {
  return std::isfinite(value) ? std::string() : std::string(name) + " is not a finite number";
}

std::string checkTime(const char* name, double value) {
  if (!std::isfinite(value)) {
    return std::string(name) + " is not a finite number";
  }
  if (value < 1e-3 * (1 - kRoundingSlack) || value > kLongestTime) {
    return std::string(name) + text(": found %g ms, allowed 1 ms to 3600 s", value * 1e3);
  }
  return std::string();
}

std::string checkWheel(const char* what, double needed, double v_max) {
  if (needed <= v_max * (1 + kRoundingSlack)) {
    return std::string();
  }
  return std::string(what) + text(": needs a wheel speed of %.4g cm/s, the wheels reach %.4g cm/s",
                                  needed * 100, v_max * 100);
}

std::string checkAbp(const RobotProgram& p, const WheelLimits& limits) {
  std::string reason = checkFinite("v (speed)", p.v);
  if (reason.empty()) reason = checkNotNegative("eta (rad/s)", p.eta);
  if (reason.empty()) reason = checkTime("epsilon (time between draws)", p.epsilon);
  if (reason.empty()) {
    reason =
        checkWheel("|v| + eta d / 2", std::fabs(p.v) + p.eta * limits.wheel_base / 2, limits.v_max);
  }
  return reason;
}

std::string checkWheelNoise(const RobotProgram& p, const WheelLimits& limits) {
  std::string reason = checkFinite("va (mean speed)", p.va);
  if (reason.empty()) reason = checkNotNegative("V (half width of the wheel speeds)", p.V);
  if (reason.empty()) reason = checkTime("epsilon (time between draws)", p.epsilon);
  if (reason.empty() && p.kind == kBp && p.va != 0) {
    reason = text("va (mean speed) of a Brownian particle: found %g cm/s, allowed 0", p.va * 100);
  }
  if (reason.empty()) reason = checkWheel("V + |va|", p.V + std::fabs(p.va), limits.v_max);
  return reason;
}

std::string checkRtp(const RobotProgram& p, const WheelLimits& limits) {
  std::string reason = checkFinite("v (speed)", p.v);
  if (reason.empty()) reason = checkNotNegative("gamma (tumbling rate, 1/s)", p.gamma);
  const double slowest = 1e6 / kLongestMeanUs;
  if (reason.empty() && (p.gamma < slowest || p.gamma > 1000)) {
    reason = text("gamma (tumbling rate): found %g /s, allowed %g to 1000 /s", p.gamma, slowest);
  }
  if (reason.empty()) reason = checkTime("tau_t (tumble time)", p.tau_t);
  if (reason.empty()) reason = checkWheel("|v|", std::fabs(p.v), limits.v_max);
  if (reason.empty()) {
    reason = checkWheel("pi d / (2 tau_t), a half turn within the tumble time tau_t",
                        kPi * limits.wheel_base / 2 / p.tau_t, limits.v_max);
    if (!reason.empty()) {
      reason += text("; allowed tau_t is at least %.3f s",
                     std::ceil(kPi * limits.wheel_base / 2 / limits.v_max * 1e3) / 1e3);
    }
  }
  return reason;
}

std::string checkWheels(const RobotProgram& p, const WheelLimits& limits) {
  std::string reason = checkFinite("left wheel", p.wheel_left);
  if (reason.empty()) reason = checkFinite("right wheel", p.wheel_right);
  if (reason.empty()) reason = checkWheel("left wheel", std::fabs(p.wheel_left), limits.v_max);
  if (reason.empty()) reason = checkWheel("right wheel", std::fabs(p.wheel_right), limits.v_max);
  return reason;
}

}  // namespace

std::string outOfRange(const RobotProgram& program, const WheelLimits& limits) {
  switch (program.kind) {
    case kNone:
      return std::string();
    case kAbp:
      return checkAbp(program, limits);
    case kNoisyAbp:
    case kBp:
      return checkWheelNoise(program, limits);
    case kRtp:
      return checkRtp(program, limits);
    case kWheels:
      return checkWheels(program, limits);
  }
  return text("program kind: found %g, allowed 0 to 5", program.kind);
}

ParamsResult toProgramParams(const RobotProgram& program, const WheelLimits& limits) {
  ParamsResult result;
  result.reason = outOfRange(program, limits);
  result.ok = result.reason.empty();
  if (!result.ok) {
    return result;
  }
  ProgramParams& params = result.params;
  params.kind = program.kind;
  switch (program.kind) {
    case kNone:
      break;
    case kAbp:
      params.speed_um_s = microPerSecond(program.v);
      params.amplitude_um_s = microPerSecond(program.eta * limits.wheel_base / 2);
      params.hold_ms = milliseconds(program.epsilon);
      break;
    case kNoisyAbp:
    case kBp:
      params.speed_um_s = microPerSecond(program.va);
      params.amplitude_um_s = microPerSecond(program.V);
      params.hold_ms = milliseconds(program.epsilon);
      break;
    case kRtp:
      params.speed_um_s = microPerSecond(program.v);
      params.mean_run_us = static_cast<uint32_t>(std::lround(1e6 / program.gamma));
      params.tumble_ms = milliseconds(program.tau_t);
      params.tumble_amplitude_um_s =
          microPerSecond(kPi * limits.wheel_base / 2 / (params.tumble_ms * 1e-3));
      break;
    case kWheels:
      params.left_um_s = microPerSecond(program.wheel_left);
      params.right_um_s = microPerSecond(program.wheel_right);
      break;
  }
  return result;
}

RobotProgram toRobotProgram(const ProgramParams& params, const WheelLimits& limits) {
  RobotProgram program;
  program.kind = params.kind;
  const bool wheel_noise = params.kind == kNoisyAbp || params.kind == kBp;
  (wheel_noise ? program.va : program.v) = params.speed_um_s * 1e-6;
  if (wheel_noise) {
    program.V = params.amplitude_um_s * 1e-6;
  } else {
    program.eta = params.amplitude_um_s * 1e-6 * 2 / limits.wheel_base;
  }
  program.epsilon = params.hold_ms * 1e-3;
  program.gamma = params.mean_run_us == 0 ? 0.0 : 1e6 / params.mean_run_us;
  program.tau_t = params.tumble_ms * 1e-3;
  program.wheel_left = params.left_um_s * 1e-6;
  program.wheel_right = params.right_um_s * 1e-6;
  return program;
}

}  // namespace dynamics
}  // namespace lab
