#include "dashboard/robots_view.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/experiment_messages.hpp"
#include "common/units.hpp"
#include "dashboard/json.hpp"

namespace lab::dashboard {
namespace {

constexpr std::int64_t kSeen_us = 1'000'000;
constexpr std::int64_t kErrorSpan_us = 10'000'000;
constexpr std::size_t kMostUnidentified = 100;

double cm(double metres) { return metres / units::kCentimetre; }
double degrees(double angle) { return angle / units::kDegree; }

bool isPlace(const tracked_pose_t& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.theta);
}

/// Standard error of a place [m], 0: not known.
double sigmaOf(const tracked_pose_t& pose) {
  const double variance = (pose.covariance[0] + pose.covariance[3]) / 2;
  return variance > 0 && std::isfinite(variance) ? std::sqrt(variance) : 0;
}

Json age(std::int64_t then, std::int64_t now) {
  return then == 0 ? Json() : number(units::seconds(now - then));
}

Json programJson(const program_t& p) {
  return {{"model", modelName(p.kind)},
          {"v_cm_s", number(cm(p.v))},
          {"va_cm_s", number(cm(p.va))},
          {"V_cm_s", number(cm(p.V))},
          {"epsilon_s", number(p.epsilon)},
          {"eta_rad_s", number(p.eta)},
          {"gamma_per_s", number(p.gamma)},
          {"tau_t_s", number(p.tau_t)},
          {"wheel_left_cm_s", number(cm(p.wheel_left))},
          {"wheel_right_cm_s", number(cm(p.wheel_right))}};
}

}  // namespace

bool RobotRow::batteryIsLow() const {
  constexpr double kLowCell = 3.4;  // [V] of a lithium cell
  constexpr double kTwoCells = 5;   // [V] more is a pack of two
  const double volts = static_cast<double>(state.battery);
  return volts > 0 && volts < (volts > kTwoCells ? 2 : 1) * kLowCell;
}

std::string RobotsView::nameOf(const RobotRow& row) const {
  return row.program < 0 ? modelName(row.state.program.kind)
                         : sheet_.programs()[static_cast<std::size_t>(row.program)];
}

RobotRow* RobotsView::rowOf(std::int32_t id) {
  const auto found = rows_.find(id);
  if (found != rows_.end()) return &found->second;
  if (rows_.size() >= kMostRobots) {
    ++left_out_;
    return nullptr;
  }
  return &rows_[id];
}

void RobotsView::take(const robot_status_t& status, std::int64_t now) {
  for (const robot_state_t& state : status.robots) {
    RobotRow* row = rowOf(state.robot_id);
    if (row == nullptr) continue;
    if (row->owner.empty() || !sameProgram(row->state.program, state.program)) {
      row->program = sheet_.indexOf(state.program);
    }
    if (row->owner != status.sender) {
      const bool other_is_alive = !row->owner.empty() && now - row->heard_utime < kSeen_us;
      if (other_is_alive) {
        row->rival = row->owner;
        row->rival_utime = now;
      }
      row->owner = status.sender;
    }
    if (row->errors_utime == 0 || now - row->errors_utime >= kErrorSpan_us) {
      row->new_errors =
          row->errors_utime == 0 ? 0 : std::max(0, state.link_errors - row->errors_before);
      row->errors_before = state.link_errors;
      row->errors_utime = now;
    }
    row->state = state;
    row->heard_utime = now;
  }
}

void RobotsView::take(const tracked_frame_t& frame, std::int64_t now) {
  ++frames_;
  frame_utime_ = frame.utime;
  for (const tracked_pose_t& pose : frame.robots) {
    if (!isPlace(pose)) continue;
    RobotRow* row = rowOf(pose.robot_id);
    if (row == nullptr) continue;
    row->pose = pose;
    row->pose_origin = frame.origin;
    row->seen_utime = now;
  }
  unidentified_ = frame.unidentified;
  std::erase_if(unidentified_, [](const tracked_pose_t& pose) { return !isPlace(pose); });
  if (unidentified_.size() > kMostUnidentified) unidentified_.resize(kMostUnidentified);
  unidentified_utime_ = now;
}

void RobotsView::clear() {
  rows_.clear();
  unidentified_.clear();
  frame_utime_ = 0;
  left_out_ = 0;
  ++frames_;
}

void RobotsView::renumber() {
  for (auto& [id, row] : rows_) row.program = sheet_.indexOf(row.state.program);
}

std::string RobotsView::frameJson(std::int64_t now) const {
  std::string text;
  text.reserve(64 + 64 * rows_.size());
  const auto out = std::back_inserter(text);
  fmt::format_to(out, FMT_COMPILE("{{\"t_us\":{},\"robots\":["), frame_utime_);
  const auto close = [&text] {
    if (text.back() == ',') text.pop_back();
    text += ']';
  };
  for (const auto& [id, row] : rows_) {
    if (row.seen_utime == 0 || now - row.seen_utime > kSeen_us) continue;
    const double confidence =
        std::isfinite(row.pose.confidence) ? static_cast<double>(row.pose.confidence) : 0;
    fmt::format_to(out, FMT_COMPILE("[{},{:.2f},{:.2f},{:.1f},{},{},{},{:.2f},{:.3f}],"), id,
                   cm(row.pose.x), cm(row.pose.y), degrees(row.pose.theta), row.program,
                   row.state.flags, row.origin(), confidence, cm(sigmaOf(row.pose)));
  }
  close();
  text += ",\"unidentified\":[";
  if (now - unidentified_utime_ <= kSeen_us) {
    for (const tracked_pose_t& pose : unidentified_) {
      fmt::format_to(out, FMT_COMPILE("[{:.2f},{:.2f},{:.1f}],"), cm(pose.x), cm(pose.y),
                     degrees(pose.theta));
    }
  }
  close();
  text += '}';
  return text;
}

std::string RobotsView::robotsJson(std::int64_t now) const {
  Json robots = Json::array();
  for (const auto& [id, row] : rows_) {
    const robot_state_t& state = row.state;
    const bool heard = !row.owner.empty();
    const double light = static_cast<double>(state.light_front + state.light_back) / 2;
    robots.push_back({{"id", id},
                      {"origin", row.origin()},
                      {"owner", row.owner},
                      {"program", heard ? Json(nameOf(row)) : Json()},
                      {"battery_V", heard && state.battery > 0 ? number(state.battery) : Json()},
                      {"battery_low", row.batteryIsLow()},
                      {"link_sent", state.link_sent},
                      {"link_received", state.link_received},
                      {"link_errors", state.link_errors},
                      {"age_s", age(row.heard_utime, now)},
                      {"flags", state.flags},
                      {"light", heard ? number(light) : Json()},
                      {"reversals", state.reversal_count},
                      {"tumbles", state.tumble_count},
                      {"stopped", (state.flags & robot_state_t::FLAG_STOPPED) != 0}});
  }
  return toText(robots);
}

std::optional<std::string> RobotsView::robotJson(std::int32_t id, std::int64_t now) const {
  const auto found = rows_.find(id);
  if (found == rows_.end()) return std::nullopt;
  const RobotRow& row = found->second;
  const robot_state_t& s = row.state;
  Json ir = Json::array();
  for (const std::int16_t reading : s.ir) ir.push_back(reading);
  Json json = {{"id", id},
               {"t_us", timeOrNull(s.utime)},
               {"age_s", age(row.heard_utime, now)},
               {"origin", row.origin()},
               {"owner", row.owner},
               {"uid", s.uid},
               {"program", row.program},
               {"program_running", programJson(s.program)},
               {"band", s.band},
               {"program_epoch", s.program_epoch},
               {"program_start_us", timeOrNull(s.program_start_utime)},
               {"wheel_left_cm_s", number(cm(s.wheel_left))},
               {"wheel_right_cm_s", number(cm(s.wheel_right))},
               {"program_left_cm_s", number(cm(s.program_left))},
               {"program_right_cm_s", number(cm(s.program_right))},
               {"light_front", number(s.light_front)},
               {"light_back", number(s.light_back)},
               {"ir", std::move(ir)},
               {"flags", s.flags},
               {"command_seq", s.command_seq},
               {"stop_seq", s.stop_seq},
               {"reversals", s.reversal_count},
               {"reversal_start_us", timeOrNull(s.reversal_start_utime)},
               {"reversal_end_us", timeOrNull(s.reversal_end_utime)},
               {"tumbles", s.tumble_count},
               {"run_time_s", number(s.run_time)},
               {"battery_V", s.battery > 0 ? number(s.battery) : Json()},
               {"link_sent", s.link_sent},
               {"link_received", s.link_received},
               {"link_errors", s.link_errors},
               {"pose", nullptr}};
  if (row.seen_utime != 0) {
    json["pose"] = {{"x_cm", number(cm(row.pose.x))},
                    {"y_cm", number(cm(row.pose.y))},
                    {"theta_deg", number(degrees(row.pose.theta))},
                    {"sigma_cm", number(cm(sigmaOf(row.pose)))},
                    {"sigma_theta_deg", number(degrees(std::sqrt(row.pose.covariance[5])))},
                    {"confidence", number(row.pose.confidence)},
                    {"age_s", age(row.seen_utime, now)}};
  }
  return toText(json);
}

}  // namespace lab::dashboard
