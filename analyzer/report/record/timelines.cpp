#include "analyzer/report/record/timelines.hpp"

#include <algorithm>

#include "analyzer/service/analysis.hpp"
#include "common/experiment/light_messages.hpp"

namespace lab::report {
namespace {

constexpr double kMsPerUs = 1e-3;
constexpr int kGrid = 24;  // sampling points along each side of the arena
constexpr std::int64_t kSilence_us =
    2'000'000;  // a robot without reports for longer is not assumed to run

bool hasImage(const std::vector<light::Layer>& layers) {
  return std::any_of(layers.begin(), layers.end(), [](const light::Layer& layer) {
    return layer.kind == light::LayerKind::kImage;
  });
}

bool canBePainted(const light::Field& field) {
  return !light::validate(field.layers) && !light::validate(field.previous);
}

std::int64_t flag(const robot_state_t& state, std::int32_t bit) {
  return (state.flags & bit) != 0 ? 1 : 0;
}

}  // namespace

void LightTimeline::take(const light_status_t& status) {
  if (!status.calibration_id.empty()) calibration_ = status.calibration_id;
  light::Field field = toField(status);
  if (!canBePainted(field)) return;
  const bool same = !spans_.empty() && field == field_ && spans_.back().label == status.label &&
                    spans_.back().commander == status.commander;
  if (same) return;
  field_ = std::move(field);
  LightSpan span;
  span.begin_utime = status.utime;
  span.label = status.label;
  span.commander = status.commander;
  measure(span);
  spans_.push_back(std::move(span));
}

void LightTimeline::measure(LightSpan& span) const {
  const light::CompiledField field(field_);
  span.uniform = light::isUniform(field_);
  span.has_image = hasImage(field_.layers) || hasImage(field_.previous);
  span.low = span.high = field.evaluate(width_ / 2, height_ / 2);
  if (span.uniform) return;
  for (int row = 0; row < kGrid; ++row) {
    for (int column = 0; column < kGrid; ++column) {
      const double value =
          field.evaluate(width_ * (column + 0.5) / kGrid, height_ * (row + 0.5) / kGrid);
      span.low = std::min(span.low, value);
      span.high = std::max(span.high, value);
    }
  }
  for (const light::Layer& layer : field_.layers) {
    if (layer.kind != light::LayerKind::kImage) continue;
    span.low = std::min({span.low, layer.intensity, layer.intensity2});
    span.high = std::max({span.high, layer.intensity, layer.intensity2});
  }
}

void RobotTimelines::take(const robot_status_t& status) {
  for (const robot_state_t& state : status.robots) {
    if (robots_.size() >= analysis::Analysis::kMostRobots && !robots_.contains(state.robot_id)) {
      continue;
    }
    take(robots_[state.robot_id], state, status.instance);
  }
}

void RobotTimelines::take(Robot& robot, const robot_state_t& state, std::int64_t instance) {
  RobotRecord& record = robot.record;
  const bool fresh = record.states == 0 || instance != robot.instance ||
                     (state.utime > robot.last_utime && state.program_epoch < robot.epoch);
  if (!fresh && state.utime <= robot.last_utime) return;
  // Counters restart with the robot: sum them over its boots.
  const std::int32_t reversals_before = fresh ? 0 : robot.reversal_count;
  const std::int32_t tumbles_before = fresh ? 0 : robot.tumble_count;
  const bool first = record.states == 0;
  if (!first) record.reversals += std::max(0, state.reversal_count - reversals_before);
  if (!first) record.tumbles += std::max(0, state.tumble_count - tumbles_before);
  if (fresh) ++record.boots;
  record.origin = state.origin;
  ++record.states;
  record.limited += flag(state, robot_state_t::FLAG_SATURATED);
  record.contact_robot += flag(state, robot_state_t::FLAG_CONTACT_ROBOT);
  record.contact_wall += flag(state, robot_state_t::FLAG_CONTACT_WALL);
  record.stopped += flag(state, robot_state_t::FLAG_STOPPED);
  record.lease_expired += flag(state, robot_state_t::FLAG_LEASE_EXPIRED);
  extendPrograms(robot, state, fresh);
  if (state.senses_utime != 0 && state.senses_utime != robot.senses_utime) {
    record.sense_delays_ms.push_back(static_cast<float>(
        static_cast<double>(state.senses_since_utime - state.senses_utime) * kMsPerUs));
    robot.senses_utime = state.senses_utime;
  }
  robot.instance = instance;
  robot.last_utime = state.utime;
  robot.epoch = state.program_epoch;
  robot.reversal_count = state.reversal_count;
  robot.tumble_count = state.tumble_count;
}

void RobotTimelines::extendPrograms(Robot& robot, const robot_state_t& state, bool fresh) const {
  std::vector<ProgramSpan>& spans = robot.record.programs;
  const int program = key_of_(state.program);
  const bool silent = !spans.empty() && state.utime - robot.last_utime > kSilence_us;
  const bool changed = spans.empty() || spans.back().program != program;
  if (!changed && !silent && !fresh) {
    spans.back().end_utime = state.utime;
    return;
  }
  // The robot reports when the program began; used if that is between the two reports.
  std::int64_t begin = state.utime;
  if (!spans.empty() && !silent && !fresh) {
    const bool fits =
        state.program_start_utime > robot.last_utime && state.program_start_utime <= state.utime;
    if (fits) begin = state.program_start_utime;
    spans.back().end_utime = begin;
  }
  spans.push_back({begin, state.utime, program});
}

std::map<std::int32_t, RobotRecord> RobotTimelines::records() const {
  std::map<std::int32_t, RobotRecord> records;
  for (const auto& [id, robot] : robots_) records.emplace(id, robot.record);
  return records;
}

}  // namespace lab::report
