#include "analyzer/tracks/reversal_finder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "analyzer/tracks/flip_filter.hpp"
#include "analyzer/tracks/uniform_motion.hpp"
#include "common/math/angle.hpp"
#include "common/math/units.hpp"
#include "light/median.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kSpeedTolerance = 0.1;  // relative error by the calibration of wheels and camera
constexpr double kLeastSpeed = 0.01;     // m/s, of an estimated speed
constexpr double kSureTime = 2.0;  // s of straight uniform motion, for an estimate of the speed
constexpr double kAlong = 0.97;    // cosine between heading and motion
constexpr double kSteadyHeading = 0.05;  // rad about its mean
constexpr double kLeastSigma = 1e-5;     // m
constexpr double kPositionSlack = 5e-4;  // m
constexpr double kSigmas = 4;
constexpr double kFalseFinds = 0.01;     // false finds per hour, by draws that happen to be alike
constexpr double kDistanceMargin = 1.1;  // inaccuracy of timers and wheels
constexpr double kHeldEdge = 0.04;       // s; beyond it the held speed may have changed
constexpr double kMadToSigma = 1.4826;

double medianOrZero(std::vector<double> values) { return values.empty() ? 0 : medianOf(values); }

/// Indices [begin, end) of a track.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
  bool backward = false;  ///< by the headings corrected so far
};

class Finder {
 public:
  Finder(std::vector<TrackPoint>& track, const ReversalSearch& search)
      : track_(track), search_(search) {}

  TrackFindings run() {
    if (search_.headings) correctHeadings();
    headings_ = continuousHeadings(track_);
    measureNoise();
    if (!search_.wanted || track_.size() < 2) {
      search_.speed = kNan;
    } else if (!std::isfinite(search_.speed)) {
      search_.speed = estimatedSpeed();
    }
    found_.speed = search_.speed;
    std::vector<Stretch> stretches;
    if (std::isfinite(search_.speed)) {
      search_.least_time = std::max(search_.least_time, leastTime(search_.speed));
      stretches = evenStretches(search_.least_time, search_.speed);
    }
    if (search_.headings && search_.sense_distance != 0) {
      settleSense(stretches);
      const bool backward = search_.sense_distance > 0;
      if (search_.one_way) {
        std::erase_if(stretches, [=](const Stretch& one) { return one.backward != backward; });
      }
    }
    for (const Stretch& stretch : stretches) measure(stretch);
    return std::move(found_);
  }

 private:
  void correctHeadings() {
    FlipFilter filter({.max_turn_rate = search_.max_turn_rate});
    chain_.reserve(track_.size());
    for (TrackPoint& point : track_) {
      found_.flips += filter.correct(point) ? 1 : 0;
      chain_.push_back(filter.chain());
    }
    found_.flip_jumps = filter.jumps();
  }

  /// Estimates the tracker noise from the apparent sideways motion, which a robot cannot make.
  void measureNoise() {
    std::vector<double> sideways;
    for (std::size_t i = 1; i < track_.size(); ++i) {
      const TrackPoint& a = track_[i - 1];
      const TrackPoint& b = track_[i];
      if (search_.headings) {
        const double theta = a.theta + 0.5 * wrapAngle(b.theta - a.theta);
        sideways.push_back(std::abs((b.y - a.y) * std::cos(theta) - (b.x - a.x) * std::sin(theta)) /
                           std::numbers::sqrt2);
      } else if (i > 1) {
        const TrackPoint& c = track_[i - 2];
        sideways.push_back(std::abs(b.x - 2 * a.x + c.x) / std::sqrt(6.0));
      }
    }
    found_.sigma = std::max(kLeastSigma, kMadToSigma * medianOrZero(std::move(sideways)));
  }

  [[nodiscard]] UniformMotion fit(std::size_t begin, std::size_t end) const {
    return uniformMotion(track_, begin, end);
  }

  /// Whether a line may be part of a reversal. Speed nan: any speed.
  [[nodiscard]] bool even(const UniformMotion& line, double time, double n, double speed) const {
    const double speed_error = found_.sigma * std::sqrt(12 / n) / time;
    const double least = std::max(kLeastSpeed, 5 * speed_error);
    const bool at_speed = std::isfinite(speed) ? std::abs(line.speed() - speed) <=
                                                     kSpeedTolerance * speed + kSigmas * speed_error
                                               : line.speed() > least;
    // The scatter of few residuals is uncertain.
    const double spread = 1 + kSigmas / std::sqrt(std::max(1.0, 4 * n - 8));
    if (!at_speed || line.rms > spread * found_.sigma + kPositionSlack / 5) return false;
    if (!search_.headings) return true;
    return line.heading_rms <= kSteadyHeading && std::abs(line.cosine()) >= kAlong;
  }

  /// Stretches of windows of uniform motion, for a length of the windows (s) and a speed (m/s).
  [[nodiscard]] std::vector<Stretch> evenStretches(double time, double speed) const {
    constexpr std::size_t kLeastFrames = 4;
    std::vector<Stretch> stretches;
    SlidingMotion sums(track_, headings_);
    std::size_t end = 0;
    for (std::size_t begin = 0; begin + kLeastFrames <= track_.size(); ++begin) {
      while (end < track_.size() &&
             (track_[end].time < track_[begin].time + time || end < begin + kLeastFrames)) {
        ++end;
      }
      sums.moveTo(begin, end);
      const double span = track_[end - 1].time - track_[begin].time;
      // Fast rejection: most windows are much slower.
      const double distance =
          std::hypot(track_[end - 1].x - track_[begin].x, track_[end - 1].y - track_[begin].y);
      if (std::isfinite(speed) && distance < 0.7 * speed * span - kSigmas * found_.sigma) continue;
      // Frames are missing, or the track ends: the window is too short.
      if (span > 2 * time || (end == track_.size() && span < time - 1.5 * framePeriod())) continue;
      const UniformMotion line = sums.motion();
      if (!even(line, span, static_cast<double>(end - begin), speed)) continue;
      const bool backward = search_.headings && line.cosine() < 0;
      if (!stretches.empty() && begin < stretches.back().end &&
          backward == stretches.back().backward) {
        stretches.back().end = end;
      } else {
        stretches.push_back({begin, end, backward});
      }
    }
    return stretches;
  }

  /// The speed of long straight uniform motion; nan: there is none.
  [[nodiscard]] double estimatedSpeed() const {
    const auto timeOf = [this](const Stretch& one) {
      return track_[one.end - 1].time - track_[one.begin].time;
    };
    std::vector<Stretch> stretches = evenStretches(std::max(kSureTime, search_.least_time), kNan);
    const bool reversed = search_.sense_distance < 0;
    if (search_.one_way) {
      std::erase_if(stretches, [=](const Stretch& one) { return one.backward == reversed; });
    }
    double longest = 0;
    for (const Stretch& one : stretches) longest = std::max(longest, timeOf(one));
    std::vector<double> speeds;
    for (const Stretch& one : stretches) {
      if (timeOf(one) > longest / 2) speeds.push_back(fit(one.begin, one.end).speed());
    }
    return speeds.empty() ? kNan : medianOf(speeds);
  }

  [[nodiscard]] double framePeriod() const {
    return (track_.back().time - track_.front().time) / static_cast<double>(track_.size());
  }

  /// The time beyond which draws of the program do not look like a reversal, s.
  [[nodiscard]] double leastTime(double speed) const {
    if (search_.hold <= 0) return 0;
    // Both wheels are drawn uniformly, so the speed has a triangular distribution.
    const double frames = std::max(4.0, search_.least_time / framePeriod());
    const double error = found_.sigma * std::sqrt(12 / frames) / search_.least_time;
    const double slowest = (1 - kSpeedTolerance) * speed - kSigmas * error;
    const double tail =
        (std::abs(search_.drawn_mean) + search_.drawn_width - slowest) / search_.drawn_width;
    if (tail <= 0) return 0;
    constexpr double kHour = 3600;
    const double chance = std::min(0.5 * tail * tail, 0.5);
    const double holds = std::log(kFalseFinds * search_.hold / kHour) / std::log(chance);
    return (std::ceil(holds) + 1) * search_.hold;
  }

  /// Flips every chain of headings along which the robot drove backward in total.
  void settleSense(std::vector<Stretch>& stretches) {
    std::vector<double> driven(static_cast<std::size_t>(chain_.empty() ? 0 : chain_.back() + 1));
    std::size_t next = 0;
    for (std::size_t i = 1; i < track_.size(); ++i) {
      while (next < stretches.size() && stretches[next].end <= i) ++next;
      const bool inside = next < stretches.size() && stretches[next].begin < i;
      if (inside || chain_[i] != chain_[i - 1]) continue;
      const TrackPoint& a = track_[i - 1];
      const TrackPoint& b = track_[i];
      const double theta = a.theta + 0.5 * wrapAngle(b.theta - a.theta);
      driven[static_cast<std::size_t>(chain_[i])] +=
          std::copysign(1.0, search_.sense_distance) *
          ((b.x - a.x) * std::cos(theta) + (b.y - a.y) * std::sin(theta));
    }
    const auto is_flipped = [&](std::size_t i) {
      return driven[static_cast<std::size_t>(chain_[i])] < -std::abs(search_.sense_distance);
    };
    for (Stretch& one : stretches) {
      if (is_flipped(one.begin)) one.backward = !one.backward;
    }
    for (std::size_t i = 0; i < track_.size(); ++i) {
      if (!is_flipped(i)) continue;
      track_[i].theta = wrapAngle(track_[i].theta + std::numbers::pi);
    }
    found_.sense_turns = std::count_if(driven.begin(), driven.end(), [this](double distance) {
      return distance < -std::abs(search_.sense_distance);
    });
  }

  /// The distance of a point from the robot on the line: along the line, and across.
  [[nodiscard]] std::pair<double, double> offLine(const UniformMotion& line,
                                                  const TrackPoint& point) const {
    const double dx = point.x - line.x - line.vx * (point.time - line.time);
    const double dy = point.y - line.y - line.vy * (point.time - line.time);
    const double v = line.speed();
    return {(dx * line.vx + dy * line.vy) / v, (dy * line.vx - dx * line.vy) / v};
  }

  /// The time at which the adjacent free motion meets the line. `outside` is the first point beyond
  /// the line, and `step` (+1 or -1) leads away from it.
  [[nodiscard]] std::optional<double> edge(const UniformMotion& line, std::size_t outside,
                                           int step) const {
    const double closing = line.speed() + search_.free_speed;
    const auto meets = [&](std::size_t i) {
      return track_[i].time + offLine(line, track_[i]).first / closing;
    };
    if (outside >= track_.size()) return std::nullopt;
    double time = meets(outside);
    for (int turn = 0; turn < 3; ++turn) {
      double sum = 0;
      double n = 0;
      for (std::size_t i = outside; i < track_.size(); i += static_cast<std::size_t>(step)) {
        const double away = step * (track_[i].time - time);
        if (n > 0 && away > search_.edge_time) break;
        if (away < 0) continue;
        sum += meets(i);
        n += 1;
      }
      if (n > 0) time = sum / n;
    }
    return time;
  }

  void measure(const Stretch& stretch) {
    // The windows at both ends extend a little into the free motion.
    constexpr double kTrim = 0.1;  // s
    Stretch core = stretch;
    while (core.end - core.begin > 4 &&
           track_[core.begin].time < track_[stretch.begin].time + kTrim) {
      ++core.begin;
    }
    while (core.end - core.begin > 4 &&
           track_[core.end - 1].time > track_[stretch.end - 1].time - kTrim) {
      --core.end;
    }
    UniformMotion line = fit(core.begin, core.end);
    const double allowed = kSigmas * found_.sigma + kPositionSlack;
    const auto on = [&](std::size_t i) {
      const auto [ahead, off] = offLine(line, track_[i]);
      return std::abs(ahead) <= allowed && std::abs(off) <= allowed;
    };
    // Extend until two successive points are off the line: a single one may be an outlier.
    const auto leaves = [&](std::size_t i, std::size_t beyond) {
      return !on(i) && (beyond >= track_.size() || !on(beyond));
    };
    std::size_t begin = core.begin;
    while (begin > 0 && !leaves(begin - 1, begin - 2)) --begin;
    std::size_t end = core.end;
    while (end < track_.size() && !leaves(end, end + 1)) ++end;
    if (end - begin > 6) line = fit(begin + 1, end - 1);

    const std::optional<double> start = edge(line, begin - 1, -1);
    const std::optional<double> stop = edge(line, end, 1);
    FoundReversal reversal;
    reversal.start = start.value_or(track_[begin].time);
    reversal.end = stop.value_or(track_[end - 1].time);
    const double time = reversal.end - reversal.start;
    if (!(time > 0) || time * line.speed() > kDistanceMargin * search_.max_distance) return;
    if (!found_.reversals.empty() && reversal.start <= found_.reversals.back().end) return;
    reversal.dx = line.vx * time;
    reversal.dy = line.vy * time;
    reversal.heading = line.heading;
    found_.reversals.push_back(reversal);
  }

  std::vector<TrackPoint>& track_;
  ReversalSearch search_;
  TrackFindings found_;
  std::vector<int> chain_;
  std::vector<double> headings_;  ///< continuous, rad
};

}  // namespace

ReversalSearch reversalSearch(const ProgramLaw& law, double speed, double distance) {
  ReversalSearch search;
  search.speed = speed;
  search.max_distance = distance;
  search.sense_distance = senseDistance(law);
  if (const auto wheels = law->drawnWheels()) {
    // The rate of reaching a wall is proportional to the speed: <v^2> / <v> over speeds toward it.
    search.free_speed = wheels->half_width / 2;
    search.edge_time = std::min(law->drawTime() / 2, kHeldEdge);
    search.hold = law->drawTime();
    search.drawn_mean = wheels->mean;
    search.drawn_width = wheels->half_width;
  } else {
    search.free_speed = std::abs(law->constantSpeed().value_or(0));
    search.one_way = search.sense_distance != 0;
    if (law->runs()) search.edge_time = kHeldEdge;
  }
  return search;
}

void ReversalReporter::report(RobotTelemetry& telemetry) {
  while (begun_ < reversals_.size() && reversals_[begun_].start <= telemetry.time) {
    if (begun_ > 0) before_ += reversals_[begun_ - 1].end - reversals_[begun_ - 1].start;
    ++begun_;
  }
  removed_ = before_;
  if (begun_ == 0) return;
  const FoundReversal& last = reversals_[begun_ - 1];
  removed_ += std::min(telemetry.time, last.end) - last.start;
  telemetry.reversal_count = static_cast<std::int64_t>(begun_);
  telemetry.reversal_start = last.start;
  telemetry.reversal_end = last.end;
  telemetry.reversal_dx = last.dx;
  telemetry.reversal_dy = last.dy;
  telemetry.reversing = telemetry.time < last.end;
}

double headingNoise(const std::vector<TrackPoint>& track) {
  constexpr double kEven = 0.1;  // relative difference between successive time steps
  std::vector<double> scatter;
  for (std::size_t i = 2; i < track.size(); ++i) {
    const double before = track[i - 1].time - track[i - 2].time;
    const double after = track[i].time - track[i - 1].time;
    if (std::abs(after - before) > kEven * before) continue;
    scatter.push_back(
        std::abs(wrapAngle(track[i].theta - 2 * track[i - 1].theta + track[i - 2].theta)));
  }
  return kMadToSigma * medianOrZero(std::move(scatter)) / std::sqrt(6);  // 1 + 4 + 1 variances
}

TrackFindings examineTrack(std::vector<TrackPoint>& track, const ReversalSearch& search) {
  return Finder(track, search).run();
}

}  // namespace lab::analysis
