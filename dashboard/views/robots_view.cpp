#include "dashboard/views/robots_view.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "dashboard/views/plausible_pose.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace {

constexpr std::int64_t kSeen_us = 1'000'000;
constexpr std::int64_t kErrorSpan_us = 10'000'000;
constexpr std::size_t kMaxUnidentified = 100;

double degrees(double angle) { return angle / units::kDegree; }

/// Standard error of a position [m], 0 if unknown.
double sigmaOf(const tracked_pose_t& pose) {
  const double variance = (pose.covariance[0] + pose.covariance[3]) / 2;
  return variance > 0 && std::isfinite(variance) ? std::sqrt(variance) : 0;
}

/// Rounds to three significant figures; null if not finite.
Json readable(double value) {
  constexpr int kFigures = 3;
  // Not std::stod(), which throws for numbers near 0 such as 5e-324.
  const std::string text = fmt::format("{:.{}g}", value, kFigures);
  return std::isfinite(value) ? Json(std::strtod(text.c_str(), nullptr)) : Json();
}

/// Rounds positions and angles to a tenth; null if not finite.
Json tenths(double value) {
  constexpr double kTenth = 0.1;
  // Adding 0 turns -0 into 0.
  return std::isfinite(value) ? Json(std::round(value / kTenth) / 10 + 0.0) : Json();
}

}  // namespace

bool RobotRow::batteryIsLow() const {
  constexpr double kLowCell = 3.4;  // [V] one lithium cell
  constexpr double kTwoCells = 5;   // [V] above, the battery has two cells
  const double volts = static_cast<double>(state.battery);
  return volts > 0 && volts < (volts > kTwoCells ? 2 : 1) * kLowCell;
}

std::string RobotsView::nameOf(const RobotRow& row) const {
  return row.program < 0 ? programName(run_info_.experiment(), row.state.program)
                         : run_info_.programs()[static_cast<std::size_t>(row.program)];
}

std::string RobotsView::phaseOf(const RobotRow& row) const {
  const Program* program = findProgram(run_info_.experiment(), row.state.program);
  const auto phase = static_cast<std::size_t>(row.state.phase);
  return program != nullptr && phase < program->phases.size() ? program->phases[phase] : "";
}

RobotRow* RobotsView::rowOf(std::int32_t id) {
  const auto found = rows_.find(id);
  if (found != rows_.end()) return &found->second;
  if (rows_.size() >= kMaxRobots) {
    ++dropped_;
    return nullptr;
  }
  return &rows_[id];
}

void RobotsView::take(const robot_status_t& status, std::int64_t now) {
  for (const robot_state_t& state : status.robots) {
    RobotRow* row = rowOf(state.robot_id);
    if (row == nullptr) continue;
    if (row->sender.empty() || row->state.program.hash != state.program.hash) {
      row->program = run_info_.indexOf(state.program);
    }
    if (row->sender != status.sender) {
      const bool other_is_alive = !row->sender.empty() && now - row->status_utime < kSeen_us;
      if (other_is_alive) {
        row->other_sender = row->sender;
        row->other_sender_utime = now;
      }
      row->sender = status.sender;
    }
    if (row->interval_utime == 0 || now - row->interval_utime >= kErrorSpan_us) {
      row->recent_errors =
          row->interval_utime == 0 ? 0 : std::max(0, state.link_errors - row->interval_errors);
      row->interval_errors = state.link_errors;
      row->interval_utime = now;
    }
    row->state = state;
    row->status_utime = now;
  }
}

void RobotsView::take(const tracked_frame_t& frame, std::int64_t now) {
  ++frames_;
  frame_utime_ = frame.utime;
  for (const tracked_pose_t& pose : frame.robots) {
    if (!isPlausiblePose(pose)) continue;
    RobotRow* row = rowOf(pose.robot_id);
    if (row == nullptr) continue;
    row->pose = pose;
    row->pose_origin = frame.origin;
    row->pose_utime = now;
  }
  unidentified_ = frame.unidentified;
  std::erase_if(unidentified_, [](const tracked_pose_t& pose) { return !isPlausiblePose(pose); });
  if (unidentified_.size() > kMaxUnidentified) unidentified_.resize(kMaxUnidentified);
  unidentified_utime_ = now;
}

void RobotsView::clear() {
  rows_.clear();
  unidentified_.clear();
  frame_utime_ = 0;
  dropped_ = 0;
  ++frames_;
}

void RobotsView::updateProgramIndices() {
  for (auto& [id, row] : rows_) row.program = run_info_.indexOf(row.state.program);
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
    if (row.pose_utime == 0 || now - row.pose_utime > kSeen_us) continue;
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
    const bool heard = !row.sender.empty();
    const double light = static_cast<double>(state.light_front + state.light_back) / 2;
    const double battery = static_cast<double>(state.battery);
    robots.push_back({{"id", id},
                      {"origin", row.origin()},
                      {"owner", row.sender},
                      {"program", heard ? Json(nameOf(row)) : Json()},
                      {"battery_V", heard && battery > 0 ? number(battery) : Json()},
                      {"battery_low", row.batteryIsLow()},
                      {"link_sent", state.link_sent},
                      {"link_received", state.link_received},
                      {"link_errors", state.link_errors},
                      {"age_s", age(row.status_utime, now)},
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
  const bool heard = !row.sender.empty();
  const bool seen = row.pose_utime != 0;
  const auto since = [now](std::int64_t then) {
    return then == 0 ? Json() : tenths(units::seconds(now - then));
  };
  const auto ofPose = [seen](Json value) { return seen ? std::move(value) : Json(); };
  Json json = {{"id", id},
               {"program", heard ? Json(nameOf(row)) : Json()},
               {"x_cm", ofPose(tenths(cm(row.pose.x)))},
               {"y_cm", ofPose(tenths(cm(row.pose.y)))},
               {"theta_deg", ofPose(tenths(degrees(row.pose.theta)))},
               {"sigma_cm", ofPose(readable(cm(sigmaOf(row.pose))))},
               {"sigma_theta_deg", ofPose(readable(degrees(std::sqrt(row.pose.covariance[5]))))},
               {"confidence", ofPose(readable(static_cast<double>(row.pose.confidence)))},
               {"seen_age_s", since(row.pose_utime)},
               {"age_s", since(row.status_utime)},
               {"origin", row.origin()},
               {"owner", row.sender},
               {"uid", s.uid},
               {"flags", s.flags},
               {"phase", heard ? Json(phaseOf(row)) : Json()},
               {"band", s.band},
               {"program_age_s", since(s.program_start_utime)},
               {"wheel_left_cm_s", readable(cm(s.wheel_left))},
               {"wheel_right_cm_s", readable(cm(s.wheel_right))},
               {"program_left_cm_s", readable(cm(s.program_left))},
               {"program_right_cm_s", readable(cm(s.program_right))},
               {"light_front", readable(static_cast<double>(s.light_front))},
               {"light_back", readable(static_cast<double>(s.light_back))},
               {"ir", s.ir},
               {"reversals", s.reversal_count},
               {"reversal_age_s", since(s.reversal_start_utime)},
               {"tumbles", s.tumble_count},
               {"run_time_s", tenths(s.run_time)},
               {"battery_V", s.battery > 0 ? readable(static_cast<double>(s.battery)) : Json()},
               {"program_epoch", s.program_epoch},
               {"command_seq", s.command_seq},
               {"stop_seq", s.stop_seq},
               {"link_sent", s.link_sent},
               {"link_received", s.link_received},
               {"link_errors", s.link_errors}};
  return toText(json);
}

}  // namespace lab::dashboard
