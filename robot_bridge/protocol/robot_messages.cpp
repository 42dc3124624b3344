#include "robot_bridge/protocol/robot_messages.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "robot/dynamics/light_table.hpp"
#include "robot/dynamics/machine.hpp"

namespace lab::bridge {
namespace {

constexpr double kMetresPerUm = 1e-6;
constexpr std::int32_t kSettled_ms = 5'000;
constexpr float kFullScale = dynamics::kLightCounts - 1;
constexpr std::int32_t kFlagsOfTheCore = dynamics::kReversing | dynamics::kStopped |
                                         dynamics::kLeaseExpired | dynamics::kTumbling |
                                         dynamics::kSaturated;

}  // namespace

std::int64_t ReportHistory::Time::at(const ClockEstimate& clock, std::uint32_t ms,
                                     std::uint32_t now_ms) {
  const bool settled = static_cast<std::int32_t>(now_ms - ms) > kSettled_ms;
  if (!known_ || ms != ms_ || !settled) utime_ = clock.utimeOf(ms);
  known_ = true;
  ms_ = ms;
  return utime_;
}

double ReportHistory::runTime(double run_time_ms, double rate) {
  if (run_time_ms < run_time_ms_) run_time_ms_ = run_time_ = 0;  // the robot has restarted
  run_time_ += (run_time_ms - run_time_ms_) * 1e-3 * rate;
  run_time_ms_ = run_time_ms;
  return run_time_;
}

bool ReportHistory::saturated(std::uint32_t count) {
  return std::exchange(saturations_, count) != count;
}

std::optional<robot_state_t> statusOf(const RobotLink& robot, std::int8_t origin,
                                      ReportHistory& reported) {
  const std::optional<RobotSnapshot>& snapshot = robot.view().snapshot();
  if (!snapshot || !robot.hello()) return std::nullopt;
  const wire::Telemetry& telemetry = snapshot->telemetry;
  const wire::State& state = snapshot->state;
  const ClockEstimate& clock = robot.clock();

  robot_state_t message{};
  // The estimate may lie after the reception, which is impossible.
  message.utime = std::min(clock.utimeOf(telemetry.t_ms), robot.heardUtime());
  message.robot_id = robot.settings().id;
  message.origin = origin;
  message.uid = robot.hello()->uid;
  const bool in_table = telemetry.slot < dynamics::kSlots;
  if (in_table) {
    message.program = robot.programOf(telemetry.config, telemetry.slot);
    message.program.hash = state.program;  // what the robot says
  } else if ((telemetry.flags & dynamics::kDriven) != 0) {
    message.program.name = kDrivenByHost;
  }
  message.phase = static_cast<std::int8_t>(telemetry.phase);
  message.band = static_cast<std::int8_t>(in_table ? telemetry.slot : -1);
  message.program_epoch = static_cast<std::int32_t>(snapshot->program_epoch);
  message.program_start_utime =
      reported.program_start.at(clock, state.program_start_ms, telemetry.t_ms);
  message.wheel_left = telemetry.left_um_s * kMetresPerUm;
  message.wheel_right = telemetry.right_um_s * kMetresPerUm;
  message.program_left = state.held_left_um_s * kMetresPerUm;
  message.program_right = state.held_right_um_s * kMetresPerUm;
  message.light_front = static_cast<float>(telemetry.sensors[0]) / kFullScale;
  message.light_back = static_cast<float>(telemetry.sensors[1]) / kFullScale;
  for (std::size_t sensor = 0; sensor < dynamics::kIrSensors; ++sensor) {
    message.ir[sensor] = static_cast<std::int16_t>(telemetry.sensors[2 + sensor]);
  }

  message.flags = telemetry.flags & kFlagsOfTheCore;
  if (reported.saturated(snapshot->saturation_count)) {
    message.flags |= robot_state_t::FLAG_SATURATED;
  }
  if (robot.isRejected()) message.flags |= robot_state_t::FLAG_REJECTED;

  message.command_seq = robot.commandSeq();
  message.command_instance = robot.commandInstance();
  message.stop_seq = robot.stopSeq();
  message.reversal_count = static_cast<std::int32_t>(snapshot->reversal_count);
  if (message.reversal_count > 0) {
    const bool reversing = (telemetry.flags & dynamics::kReversing) != 0;
    message.reversal_start_utime =
        reported.reversal_start.at(clock, state.reversal_start_ms, telemetry.t_ms);
    message.reversal_end_utime =
        reversing ? 0 : reported.reversal_end.at(clock, state.reversal_end_ms, telemetry.t_ms);
  }
  message.tumble_count = static_cast<std::int32_t>(snapshot->tumble_count);
  message.run_time = reported.runTime(snapshot->run_time_ms, clock.rate());
  message.senses_utime = robot.senses().utime;
  message.senses_since_utime = robot.senses().since_utime;
  message.battery = static_cast<float>(snapshot->battery);
  message.link_sent = static_cast<std::int32_t>(robot.counters().sent);
  message.link_received = static_cast<std::int32_t>(robot.counters().received);
  message.link_errors = static_cast<std::int32_t>(robot.counters().errors) +
                        static_cast<std::int32_t>(robot.view().framesBad());
  return message;
}

robot_step_t stepOf(const RobotLink& robot, const RobotView::UnwrappedStep& long_step) {
  const wire::Step& step = long_step.step;
  robot_step_t message{};
  message.utime = robot.clock().utimeOf(step.t_ms);
  message.robot_id = robot.settings().id;
  message.draw_count = static_cast<std::int32_t>(step.draw_count);
  message.program_epoch = static_cast<std::int32_t>(long_step.program_epoch);
  message.slot = static_cast<std::int8_t>(step.slot < dynamics::kSlots ? step.slot : -1);
  message.phase = static_cast<std::int8_t>(step.phase);
  message.wheel_left = step.left_um_s * kMetresPerUm;
  message.wheel_right = step.right_um_s * kMetresPerUm;
  message.duration = step.duration_ms == dynamics::kEndless ? -1 : step.duration_ms * 1e-3;
  message.rng = step.rng;
  return message;
}

}  // namespace lab::bridge
