#include "analyzer/tracks/track_stitcher.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/math/angle.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

constexpr double kLogKept = 1.0;           // s of telemetry before the last sample
constexpr std::size_t kMaxLog = 4096;      // messages
constexpr std::size_t kMaxPending = 4096;  // frames
constexpr int kBackwardsIsRestart =
    50;  // frames in a row: then the clock of the camera was set back
constexpr double kPositionSlack = 0.002;  // m beyond the possible displacement and the noise
constexpr double kHeadingSlack = 0.2;     // rad beyond the possible turn and the noise
constexpr double kSigmas = 7;
constexpr int kBridgeSteps = 8;

bool isFinite(const RobotTelemetry& t) {
  return std::isfinite(t.time) && std::isfinite(t.program_start) && std::isfinite(t.v_l) &&
         std::isfinite(t.v_r) && std::isfinite(t.run_time) &&
         (t.reversal_count == 0 ||
          (std::isfinite(t.reversal_start) && (t.reversing || std::isfinite(t.reversal_end))));
}

double endOf(const RobotTelemetry& t) {
  return t.reversing ? std::numeric_limits<double>::infinity() : t.reversal_end;
}

/// The run time at a frame between two messages, interpolated. The run time of the last message
/// would be up to 20 ms too small at the end of every stay in the program and not at its beginning:
/// 0.1 % of the speed in a recording of 30 s.
double runTimeAt(double time, const RobotTelemetry& before, const RobotTelemetry& next) {
  // If a program begins in between, run time increases on one side of the beginning only.
  double begin = before.time;
  double end = next.time;
  if (next.program_epoch != before.program_epoch && next.program_start > before.time) {
    (time < next.program_start ? end : begin) = next.program_start;
  }
  const double grown = next.run_time - before.run_time;
  if (!(grown >= 0) || !(end > begin)) {
    return next.run_time;  // the robot has rebooted
  }
  // No more than the increase. Run time may exceed the time of the frames by the last millisecond
  // of the robot's clock; this averages out, and clipping would not.
  return before.run_time + grown * std::clamp((time - begin) / (end - begin), 0.0, 1.0);
}

}  // namespace

ProgramTally& ProgramTally::operator+=(const ProgramTally& other) {
  samples += other.samples;
  in_contact += other.in_contact;
  in_reversal += other.in_reversal;
  stopped += other.stopped;
  lost += other.lost;
  segments += other.segments;
  reversals += other.reversals;
  return *this;
}

void TrackStitcher::addFrame(const TrackPoint& point, std::vector<Sample>& out) {
  ++counters_.frames;
  if (!point.valid || !std::isfinite(point.time) || !std::isfinite(point.x) ||
      !std::isfinite(point.y) || !std::isfinite(point.theta)) {
    ++counters_.invalid;
    return;
  }
  if (point.time <= newest_frame_) {
    ++counters_.out_of_order;
    if (++backwards_ < kBackwardsIsRestart) {
      return;
    }
    restart();
  }
  backwards_ = 0;
  newest_frame_ = point.time;
  newest_ = std::max(newest_, point.time);
  pending_.push_back(point);
  processPending(pending_.size() > kMaxPending, out);
}

void TrackStitcher::addTelemetry(const RobotTelemetry& telemetry, std::vector<Sample>& out) {
  const auto place = std::lower_bound(
      log_.begin(), log_.end(), telemetry,
      [](const RobotTelemetry& a, const RobotTelemetry& b) { return a.time < b.time; });
  const bool repeated = place != log_.end() && place->time == telemetry.time;
  const bool too_late = place == log_.begin() && !log_.empty();
  if (!isFinite(telemetry) || repeated || too_late) {
    ++counters_.bad_telemetry;
    return;
  }
  log_.insert(place, telemetry);
  if (log_.size() > kMaxLog) {
    log_.pop_front();
  }
  newest_ = std::max(newest_, telemetry.time);
  processPending(false, out);
}

void TrackStitcher::flush(std::vector<Sample>& out) {
  processPending(true, out);
  closePiece(PieceEnd::kEnd);
}

ProgramTally TrackStitcher::tally(int program) const {
  const auto i = static_cast<std::size_t>(program);
  return program >= 0 && i < tallies_.size() ? tallies_[i] : ProgramTally{};
}

ProgramTally& TrackStitcher::tallyOf(int program) {
  const auto i = static_cast<std::size_t>(program);
  if (i >= tallies_.size()) {
    tallies_.resize(i + 1);
  }
  return tallies_[i];
}

void TrackStitcher::processPending(bool force, std::vector<Sample>& out) {
  const double ahead = std::max(config_.contact_guard, config_.reversal_guard);
  while (!pending_.empty()) {
    const double time = pending_.front().time;
    const bool covered = !log_.empty() && log_.back().time >= time + ahead;
    if (!force && !covered && newest_ - time <= config_.reorder_delay) {
      break;
    }
    process(pending_.front(), out);
    pending_.pop_front();
    const double keep = (last_ && !cut_ ? last_->time : time) - kLogKept;
    while (log_.size() > 2 && log_[1].time < keep) {
      log_.pop_front();
    }
  }
}

void TrackStitcher::process(TrackPoint point, std::vector<Sample>& out) {
  if (config_.headings) {
    counters_.flips += flips_.correct(point) ? 1 : 0;
    counters_.flip_jumps = flips_.jumps();
  }
  Context context;
  const FrameClass frame_class = classify(point, context);
  if (config_.report_frames) report(point, frame_class, context);
  if (frame_class != FrameClass::kFree) {
    drop(frame_class, context);
    return;
  }
  double gap = last_ ? point.time - last_->time : 0;
  switch (linkTo(point, context)) {
    case Link::kSamePiece:
      if (!reachable(*last_, point)) {
        ++counters_.outliers;
        ++tallyOf(context.program).lost;
        const bool real = suspect_ && reachable(*suspect_, point);
        suspect_ = point;
        if (!real) {
          if (config_.report_frames) reports_.back().state = FrameState::kLost;
          return;
        }
        // Two frames agree with each other and not with the track: a real jump.
        ++counters_.jumps;
        cut(PieceEnd::kJump);
      }
      break;
    case Link::kJoin:
      if (!config_.join) {
        cut(PieceEnd::kNotJoined);
        break;
      }
      gap -= context.after->reversal_end - context.after->reversal_start;
      join(point, *context.after);
      ++counters_.reversals;
      ++tallyOf(context.program).reversals;
      break;
    case Link::kLostReversal:
      ++counters_.lost_reversals;
      cut(PieceEnd::kLostReversal);
      break;
    case Link::kFirst:
    case Link::kCut:
      cut(PieceEnd::kProgramSwitch);
      break;
  }
  append(point, context, gap, out);
}

TrackStitcher::FrameClass TrackStitcher::classify(const TrackPoint& point, Context& context) const {
  const auto next =
      std::lower_bound(log_.begin(), log_.end(), point.time,
                       [](const RobotTelemetry& a, double time) { return a.time < time; });
  if (next == log_.end()) {
    return FrameClass::kUncovered;
  }
  const RobotTelemetry* before = next == log_.begin() ? nullptr : &*(next - 1);

  const bool before_is_nearer =
      before != nullptr && point.time - before->time < next->time - point.time;
  context.nearest = before_is_nearer ? before : &*next;

  // The epoch: that of the next message if it has begun, else the one before.
  const RobotTelemetry* state = &*next;
  if (point.time < next->program_start) {
    if (before == nullptr || before->program_epoch != next->program_epoch - 1) {
      return FrameClass::kUncovered;
    }
    state = before;
  }
  context.program = state->program;
  context.epoch = state->program_epoch;
  const bool since_before = before != nullptr && before->program_epoch == context.epoch;
  const RobotTelemetry* last = since_before && next->time > point.time ? before : state;
  context.tumble_count = last->tumble_count;
  context.run_time = before != nullptr ? runTimeAt(point.time, *before, *next) : next->run_time;
  context.sense_distance = state->sense_distance;
  context.stopped = state->stopped || (since_before && before->stopped);
  if (state->program < 0 || context.stopped) {
    return FrameClass::kStanding;
  }
  if (nearContact(point.time, next)) {
    return FrameClass::kContact;
  }

  // Each message has the times of the last reversal.
  context.reversals = next->reversal_count;
  context.after = &*next;
  if (next->reversal_count > 0 && point.time < endOf(*next)) {
    context.reversals = next->reversal_count - 1;
    context.after = before;
  }
  if (nearReversal(point.time, next)) {
    return FrameClass::kReversal;
  }
  if (context.reversals < next->reversal_count && before != nullptr &&
      (before->reversal_count != context.reversals || before->reversing)) {
    return FrameClass::kLostReversal;
  }
  return FrameClass::kFree;
}

bool TrackStitcher::nearContact(double time, Log::const_iterator next) const {
  const double guard = config_.contact_guard;
  if (next->contact || (next != log_.begin() && (next - 1)->contact)) {
    return true;
  }
  for (auto i = next; i != log_.end() && i->time <= time + guard; ++i) {
    if (i->contact) {
      return true;
    }
  }
  for (auto i = next; i != log_.begin() && (i - 1)->time >= time - guard; --i) {
    if ((i - 1)->contact) {
      return true;
    }
  }
  return false;
}

bool TrackStitcher::nearReversal(double time, Log::const_iterator next) const {
  const double guard = config_.reversal_guard;
  const auto inside = [time, guard](const RobotTelemetry& t) {
    return t.reversal_count > 0 && time > t.reversal_start - guard && time < endOf(t) + guard;
  };
  if (inside(*next)) {
    return true;
  }
  // If an earlier message reports an unfinished reversal, the next one has its end.
  if (next != log_.begin() && !(next - 1)->reversing && inside(*(next - 1))) {
    return true;
  }
  for (auto i = next; guard > 0 && i != log_.end() && i->time <= time + guard; ++i) {
    if (inside(*i)) {
      return true;
    }
  }
  return false;
}

TrackStitcher::Link TrackStitcher::linkTo(const TrackPoint& point, const Context& context) const {
  if (!last_) {
    return Link::kFirst;
  }
  if (cut_ || context.epoch != last_context_.epoch || context.program != last_context_.program) {
    return Link::kCut;
  }
  if (context.reversals == last_context_.reversals) {
    return Link::kSamePiece;
  }
  const RobotTelemetry* reversal = context.after;
  if (context.reversals != last_context_.reversals + 1 || reversal == nullptr ||
      reversal->reversal_count != context.reversals || reversal->reversing) {
    return Link::kLostReversal;
  }
  const double before = reversal->reversal_start - last_->time;
  const double after = point.time - reversal->reversal_end;
  const bool bridged = before >= 0 && after >= 0 && before + after <= config_.max_join_gap;
  return bridged ? Link::kJoin : Link::kLostReversal;
}

bool TrackStitcher::reachable(const TrackPoint& from, const TrackPoint& to) const {
  const double dt = to.time - from.time;
  const double distance = std::hypot(to.x - from.x, to.y - from.y);
  const double noise = kSigmas * std::hypot(from.sigma, to.sigma);
  const double turn = std::abs(wrapAngle(to.theta - from.theta));
  const double turn_noise = kSigmas * std::hypot(from.sigma_theta, to.sigma_theta);
  const bool turns =
      !config_.headings ||
      turn <= 2 * config_.max_wheel_speed / config_.wheel_base * dt + turn_noise + kHeadingSlack;
  return turns && distance <= config_.max_wheel_speed * dt + noise + kPositionSlack;
}

void TrackStitcher::report(const TrackPoint& point, FrameClass frame_class,
                           const Context& context) {
  FrameReport& frame = reports_.emplace_back();
  frame.time = point.time;
  frame.x = point.x;
  frame.y = point.y;
  frame.theta = config_.headings ? point.theta : units::kNan;
  frame.program = context.program;
  frame.epoch = context.epoch;
  if (context.nearest != nullptr) {
    frame.contact_robot = context.nearest->contact_robot;
    frame.contact_wall = context.nearest->contact_wall;
    frame.light_front = context.nearest->light_front;
    frame.light_back = context.nearest->light_back;
  }
  switch (frame_class) {
    case FrameClass::kFree:
      frame.state = FrameState::kFree;
      break;
    case FrameClass::kReversal:
      frame.state = FrameState::kReversing;
      break;
    case FrameClass::kContact:
      frame.state = FrameState::kContact;
      break;
    case FrameClass::kStanding:
      frame.state = context.stopped ? FrameState::kStopped : FrameState::kOther;
      break;
    case FrameClass::kUncovered:
    case FrameClass::kLostReversal:
      frame.state = FrameState::kLost;
      break;
  }
}

void TrackStitcher::drop(FrameClass frame_class, const Context& context) {
  const int program = context.program;
  PieceEnd reason = PieceEnd::kStop;
  switch (frame_class) {
    case FrameClass::kUncovered:
      ++counters_.uncovered;
      if (!cut_ && last_) {
        ++tallyOf(last_context_.program).lost;
      }
      return;
    case FrameClass::kStanding:
      ++counters_.standing;
      if (program >= 0) ++tallyOf(program).stopped;
      break;
    case FrameClass::kReversal:
      ++counters_.in_reversal;
      ++tallyOf(program).in_reversal;
      return;
    case FrameClass::kContact:
      ++counters_.in_contact;
      ++tallyOf(program).in_contact;
      reason = PieceEnd::kContact;
      break;
    case FrameClass::kLostReversal:
      counters_.lost_reversals += cut_ ? 0 : 1;
      ++tallyOf(program).lost;
      reason = PieceEnd::kLostReversal;
      break;
    case FrameClass::kFree:
      return;
  }
  cut(reason);
}

void TrackStitcher::cut(PieceEnd reason) {
  if (!cut_) {
    closePiece(reason);
  }
  cut_ = true;
}

void TrackStitcher::closePiece(PieceEnd reason) {
  if (piece_.frames > 0) {
    piece_.reason = reason;
    pieces_.push_back(piece_);
  }
  piece_ = {};
}

void TrackStitcher::join(const TrackPoint& point, const RobotTelemetry& reversal) {
  const double before = reversal.reversal_start - last_->time;
  const double removed = reversal.reversal_end - reversal.reversal_start;
  const double total = point.time - last_->time - removed;
  const double offset_x = offset_x_;
  const double offset_y = offset_y_;
  const auto finish = [&] {
    piece_.reversal_start = reversal.reversal_start;
    piece_.reversal_end = reversal.reversal_end;
    piece_.dx = offset_x - offset_x_;
    piece_.dy = offset_y - offset_y_;
    piece_.rotation = wrapAngle(point.theta - last_->theta);
    closePiece(PieceEnd::kJoined);
    removed_ += removed;
    ++sample_.piece;
  };
  if (std::isfinite(reversal.reversal_dx) && std::isfinite(reversal.reversal_dy)) {
    offset_x_ -= reversal.reversal_dx;
    offset_y_ -= reversal.reversal_dy;
    finish();
    return;
  }
  // Time of telemetry on the axis of free time since the last frame: a reversal takes no time.
  const auto freeTime = [&](const RobotTelemetry& t) {
    const double since = t.time - last_->time;
    return since < before ? since : std::max(before, since - removed);
  };
  double x = sample_.x;
  double y = sample_.y;
  double theta = last_->theta;
  const double dt = total / kBridgeSteps;
  for (int step = 0; step < kBridgeSteps; ++step) {
    const double at = (step + 0.5) * dt;
    const auto held = std::min_element(log_.begin(), log_.end(), [&](const auto& a, const auto& b) {
      return std::abs(freeTime(a) - at) < std::abs(freeTime(b) - at);
    });
    const double turn = (held->v_r - held->v_l) / config_.wheel_base * dt;
    const double forward = 0.5 * (held->v_l + held->v_r) * dt;
    x += forward * std::cos(theta + 0.5 * turn);
    y += forward * std::sin(theta + 0.5 * turn);
    theta += turn;
  }
  offset_x_ = x - point.x;
  offset_y_ = y - point.y;
  finish();
}

/// Lets programs that drive forward show which end of the robot is its head.
void TrackStitcher::watchSense(TrackPoint& point, double sense_distance) {
  // Robots turn little between frames, and the sum over many frames decides.
  const double middle = last_->theta + 0.5 * wrapAngle(point.theta - last_->theta);
  const double forward =
      (point.x - last_->x) * std::cos(middle) + (point.y - last_->y) * std::sin(middle);
  if (flips_.addMotion(forward, sense_distance)) {
    ++counters_.sense_turns;
    ++sample_.angular_segment;
    point.theta = wrapAngle(point.theta + std::numbers::pi);
  }
}

void TrackStitcher::append(TrackPoint point, const Context& context, double gap,
                           std::vector<Sample>& out) {
  if (config_.headings && !cut_ && context.reversals == last_context_.reversals) {
    watchSense(point, context.sense_distance);
  }
  if (cut_) {
    ++sample_.segment;
    ++sample_.piece;
    ++sample_.angular_segment;
    ++tallyOf(context.program).segments;
    offset_x_ = 0;
    offset_y_ = 0;
    sample_.theta = point.theta;
  } else {
    if (gap > config_.max_angular_gap) {
      ++sample_.angular_segment;
    }
    sample_.theta += wrapAngle(point.theta - last_->theta);
  }
  if (!config_.headings) {
    sample_.theta = units::kNan;
    ++sample_.angular_segment;
  }
  cut_ = false;
  suspect_.reset();
  sample_.time = point.time;
  sample_.free_time = point.time - removed_;
  sample_.frame = point.frame;
  sample_.x = point.x + offset_x_;
  sample_.y = point.y + offset_y_;
  sample_.program = context.program;
  sample_.tumble_count = context.tumble_count;
  sample_.run_time = context.run_time;
  last_ = point;
  last_context_ = {context.program, context.epoch, context.reversals, nullptr, 0, 0, 0,
                   false,           nullptr};
  if (piece_.frames++ == 0) {
    piece_.program = sample_.program;
    piece_.segment = sample_.segment;
    piece_.piece = sample_.piece;
    piece_.begin = point.time;
  }
  piece_.end = point.time;
  ++counters_.samples;
  ++tallyOf(context.program).samples;
  out.push_back(sample_);
}

void TrackStitcher::restart() {
  pending_.clear();
  log_.clear();
  newest_ = -1e300;
  cut(PieceEnd::kClockSetBack);
  flips_ = FlipFilter({.max_turn_rate = 2 * config_.max_wheel_speed / config_.wheel_base});
  last_.reset();
  suspect_.reset();
}

}  // namespace lab::analysis
