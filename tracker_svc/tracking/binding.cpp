#include "tracker_svc/tracking/binding.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lab::tracker {
namespace {

constexpr double kSlice = 0.1;  // [s] shortest slice; with slow cameras a slice is one frame
constexpr double kLongestSlice = 0.35;  // [s] in a longer one a robot may turn too far
constexpr double kTimeout = 1.1;        // [s] reports are at most a second late
constexpr double kSilence = 1.5;        // [s] after which a silent robot is not waited for
// [ln] a change inside a slice affects two slices: the second counts less
constexpr double kSecondPart = 2.5;
const double kLogTwoPi = std::log(2 * std::numbers::pi);
constexpr double kHighestFree = 60;  // [ln] limit, so that later contradictions count
constexpr double kHighestBound = 30;
constexpr double kSuspicion = -10;  // [ln] evidence below which other robots are compared
constexpr double kProven = 20;      // [ln]
constexpr double kUnproven = -5;    // [ln] lower evidence ends a recent binding
constexpr int kContrary = 100;      // slices at the lowest evidence that end a binding

double square(double x) { return x * x; }

}  // namespace

MotionBinding::MotionBinding(const MotionSettings& settings, std::vector<std::int32_t> robot_ids)
    : settings_(settings), ids_(std::move(robot_ids)) {
  std::sort(ids_.begin(), ids_.end());
  ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
  logs_.resize(ids_.size());
  paths_.resize(ids_.size());
}

int MotionBinding::indexOf(std::int32_t robot_id) const {
  const auto place = std::lower_bound(ids_.begin(), ids_.end(), robot_id);
  if (place == ids_.end() || *place != robot_id) return -1;
  return static_cast<int>(place - ids_.begin());
}

void MotionBinding::addReport(std::int32_t robot_id, double time, double left, double right) {
  const int robot = indexOf(robot_id);
  if (robot < 0) return;
  WheelLog& log = logs_[static_cast<std::size_t>(robot)];
  log.add(time, left, right);
  log.forgetBefore(time - 10);
}

bool MotionBinding::isDue(double time) const {
  return !started_ || time - slice_begin_ > kSlice - 1e-6;
}

void MotionBinding::step(double time, std::span<IdentityEvidence* const> caps) {
  measure(time, caps);
  bool weighed = false;
  while (!slices_.empty() && isReady(slices_.front(), time)) {
    bound_caps_.assign(ids_.size(), nullptr);
    for (IdentityEvidence* cap : caps) {
      if (cap->robot >= 0) bound_caps_[static_cast<std::size_t>(cap->robot)] = cap;
    }
    weigh(slices_.front(), caps);
    slices_.pop_front();
    weighed = true;
  }
  if (!weighed) return;
  prior_ = prior(caps);
  doubt(caps);
  bindFree(caps);
}

void MotionBinding::measure(double time, std::span<IdentityEvidence* const> caps) {
  const double duration = time - slice_begin_;
  const bool valid = started_ && duration <= kLongestSlice;
  const std::int64_t number = next_slice_++;
  for (IdentityEvidence* cap : caps) {
    if (valid && cap->begun && cap->placed) {
      SliceMotion& motion = cap->motions[static_cast<std::size_t>(number) % cap->motions.size()];
      motion.slice = number;
      motion.travel = wheelsBetween(cap->begin, cap->place, settings_.wheel_base);
      motion.before = {cap->speeds.left * duration, cap->speeds.right * duration};
      motion.duration = duration;
      motion.touching = cap->touching || cap->begin_touching;
      motion.variance = cap->variance + cap->begin_variance;
      cap->speeds = {motion.travel.left / duration, motion.travel.right / duration};
    } else {
      cap->speeds = {};
    }
    cap->begun = cap->placed;
    cap->begin = cap->place;
    cap->begin_variance = cap->variance;
    cap->begin_touching = cap->touching;
  }
  if (valid) slices_.push_back({number, slice_begin_, time});
  slice_begin_ = time;
  started_ = true;
}

bool MotionBinding::isReady(const Slice& slice, double time) const {
  if (time - slice.end > kTimeout) return true;
  return std::all_of(logs_.begin(), logs_.end(), [&](const WheelLog& log) {
    return log.isEmpty() || log.latest() >= slice.end || log.latest() < slice.end - kSilence;
  });
}

/// Density of a foreign cap's motion: it keeps its speeds, or gets new ones with the distribution
/// of robots' speeds. A change in the middle of a slice appears in that slice and the next, but
/// counts once.
void MotionBinding::expectOfForeign(IdentityEvidence& cap, SliceMotion& motion,
                                    double fastest) const {
  const double left =
      WheelLog::randomVariance(motion.before.left, motion.duration) + motion.variance;
  const double right =
      WheelLog::randomVariance(motion.before.right, motion.duration) + motion.variance;
  const double held = (square(motion.travel.left - motion.before.left) / left +
                       square(motion.travel.right - motion.before.right) / right) /
                      2;
  const double peak = -kLogTwoPi - std::log(left * right) / 2;
  double speed_change_log_ratio = held;
  if (held > 1) {
    const double variance =
        motion.variance + (WheelLog::randomVariance(motion.travel.left, motion.duration) +
                           WheelLog::randomVariance(motion.travel.right, motion.duration)) /
                              2;
    const double any =
        peak - std::log(motion_prior_.changes() *
                        motion_prior_.density(motion.travel, variance, motion.duration, fastest));
    speed_change_log_ratio = std::min(held, any);
    if (cap.speed_change_log_ratio > 1) {
      speed_change_log_ratio = std::min(
          speed_change_log_ratio, std::max(0.0, any - cap.speed_change_log_ratio) + kSecondPart);
    }
  }
  cap.speed_change_log_ratio = speed_change_log_ratio;
  motion.speed_change_log_ratio = speed_change_log_ratio;
  motion.foreign = peak - speed_change_log_ratio;
}

void MotionBinding::weigh(const Slice& slice, std::span<IdentityEvidence* const> caps) {
  for (std::size_t r = 0; r < logs_.size(); ++r) paths_[r] = logs_[r].path(slice.begin, slice.end);
  motion_prior_.add(paths_, slice.end - slice.begin);
  const double fastest = settings_.max_wheel_speed * (slice.end - slice.begin);
  for (IdentityEvidence* cap : caps) {
    SliceMotion& motion =
        cap->motions[static_cast<std::size_t>(slice.number) % cap->motions.size()];
    if (motion.slice != slice.number) continue;
    expectOfForeign(*cap, motion, fastest);
    const bool open = cap->robot < 0 || cap->suspect;
    for (std::size_t r = 0; r < paths_.size(); ++r) {
      const bool own = cap->robot == static_cast<int>(r);
      if (!open && !own && bound_caps_[r] != nullptr) {
        cap->pairs[r] = PairEvidence();
      } else if (paths_[r].known) {
        cap->pairs[r].add(motion, paths_[r], own ? kHighestBound : kHighestFree);
      }
    }
  }
}

void MotionBinding::unbind(IdentityEvidence& cap) {
  bound_caps_[static_cast<std::size_t>(cap.robot)] = nullptr;
  cap.robot = -1;
  cap.suspect = false;
  cap.contrary = 0;
  ++unbound_;
}

/// Ends a binding if another robot explains the cap, or another cap the robot, far better than they
/// explain each other, or if no robot has explained the cap for a long time.
void MotionBinding::doubt(std::span<IdentityEvidence* const> caps) {
  for (IdentityEvidence* cap : caps) {
    if (cap->robot < 0) continue;
    const double own = cap->pairs[static_cast<std::size_t>(cap->robot)].value();
    cap->suspect = own < kSuspicion;
    const bool pushed = cap->pairs[static_cast<std::size_t>(cap->robot)].isPushed();
    cap->contrary = own > PairEvidence::kLowest + 1 ? 0 : cap->contrary + (pushed ? 1 : 0);
    cap->proven = cap->proven || own > kProven;
    if (cap->contrary >= kContrary || (!cap->proven && own < kUnproven)) unbind(*cap);
  }
  for (IdentityEvidence* cap : caps) {
    for (std::size_t r = 0; r < ids_.size(); ++r) {
      if (cap->robot == static_cast<int>(r)) continue;
      if (cap->robot >= 0 && !cap->suspect) break;
      const double value = cap->pairs[r].value();
      if (value + prior_ < kBindRatio) continue;
      IdentityEvidence* const holder = bound_caps_[r];
      if (holder != nullptr && value > holder->pairs[r].value() + kBindRatio) unbind(*holder);
      if (cap->robot >= 0 &&
          value > cap->pairs[static_cast<std::size_t>(cap->robot)].value() + kBindRatio) {
        unbind(*cap);
      }
    }
  }
}

double MotionBinding::prior(std::span<IdentityEvidence* const> caps) const {
  const auto seen = std::count_if(caps.begin(), caps.end(),
                                  [](const IdentityEvidence* cap) { return cap->placed; });
  const auto reporting = std::count_if(logs_.begin(), logs_.end(), [&](const WheelLog& log) {
    return !log.isEmpty() && log.latest() > slice_begin_ - kSilence;
  });
  return seen > reporting ? kLogPriorOwnRobotAmongMore : kLogPriorOwnRobot;
}

void MotionBinding::bindFree(std::span<IdentityEvidence* const> caps) {
  free_caps_.clear();
  free_robots_.clear();
  for (std::size_t r = 0; r < ids_.size(); ++r) {
    if (bound_caps_[r] == nullptr) free_robots_.push_back(r);
  }
  bool clear = false;
  for (IdentityEvidence* cap : caps) {
    if (cap->robot >= 0) continue;
    free_caps_.push_back(cap);
    for (const std::size_t r : free_robots_) {
      clear = clear || cap->pairs[r].value() + prior_ >= kBindRatio;
    }
  }
  if (!clear) {
    for (IdentityEvidence* cap : free_caps_) cap->candidate = -1;
    return;
  }
  assignment_.reset(free_caps_.size(), free_robots_.size());
  for (std::size_t i = 0; i < free_caps_.size(); ++i) {
    for (std::size_t j = 0; j < free_robots_.size(); ++j) {
      const double value = free_caps_[i]->pairs[free_robots_[j]].value() + prior_;
      if (value > 0) assignment_.allow(i, j, -value);
    }
  }
  assignment_.solve();
  for (std::size_t i = 0; i < free_caps_.size(); ++i) {
    IdentityEvidence& cap = *free_caps_[i];
    const int column = assignment_.columnOf(i);
    if (column < 0 || assignment_.margin(i) < kBindRatio) {
      cap.candidate = -1;
      continue;
    }
    const std::size_t robot = free_robots_[static_cast<std::size_t>(column)];
    cap.confirmed = cap.candidate == static_cast<int>(robot) ? cap.confirmed + 1 : 1;
    cap.candidate = static_cast<int>(robot);
    if (cap.confirmed >= kConfirm) bindTo(cap, robot);
  }
}

void MotionBinding::bindTo(IdentityEvidence& cap, std::size_t robot) {
  cap.robot = static_cast<int>(robot);
  cap.candidate = -1;
  cap.proven = false;
  cap.suspect = false;
  cap.contrary = 0;
  bound_caps_[robot] = &cap;
  ++bound_;
}

}  // namespace lab::tracker
