#include "analyzer/tracks/uniform_motion.hpp"

#include <algorithm>

#include "common/math/angle.hpp"

namespace lab::analysis {
namespace {

/// The root mean square per axis, for the squares of n points with four fitted numbers.
double scatterPerAxis(double squares, double n) {
  return std::sqrt(squares / std::max(1.0, 2 * n - 4));
}

}  // namespace

UniformMotion uniformMotion(const std::vector<TrackPoint>& track, std::size_t begin,
                            std::size_t end) {
  UniformMotion motion;
  const double n = static_cast<double>(end - begin);
  double c = 0;
  double s = 0;
  for (std::size_t i = begin; i < end; ++i) {
    motion.time += (track[i].time - track[begin].time) / n;
    motion.x += track[i].x / n;
    motion.y += track[i].y / n;
    c += std::cos(track[i].theta);
    s += std::sin(track[i].theta);
  }
  motion.time += track[begin].time;
  motion.heading = std::atan2(s, c);
  double tt = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const double t = track[i].time - motion.time;
    tt += t * t;
    motion.vx += t * (track[i].x - motion.x);
    motion.vy += t * (track[i].y - motion.y);
  }
  motion.vx /= tt;
  motion.vy /= tt;
  double squares = 0;
  double turns = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const double t = track[i].time - motion.time;
    squares += std::pow(track[i].x - motion.x - motion.vx * t, 2) +
               std::pow(track[i].y - motion.y - motion.vy * t, 2);
    turns += std::pow(wrapAngle(track[i].theta - motion.heading), 2);
  }
  motion.rms = scatterPerAxis(squares, n);
  motion.heading_rms = std::sqrt(turns / n);
  return motion;
}

std::vector<double> continuousHeadings(const std::vector<TrackPoint>& track) {
  std::vector<double> headings;
  headings.reserve(track.size());
  for (const TrackPoint& point : track) {
    headings.push_back(headings.empty()
                           ? point.theta
                           : headings.back() + wrapAngle(point.theta - headings.back()));
  }
  return headings;
}

void SlidingMotion::moveTo(std::size_t begin, std::size_t end) {
  while (end_ < end) add(end_++, 1);
  while (begin_ < begin) add(begin_++, -1);
  if (begin_ - origin_ < end_ - begin_) return;
  origin_ = begin_;
  sums_ = {};
  for (std::size_t i = begin_; i < end_; ++i) add(i, 1);
}

void SlidingMotion::add(std::size_t point, double sign) {
  const double t = track_[point].time - track_[origin_].time;
  const double x = track_[point].x - track_[origin_].x;
  const double y = track_[point].y - track_[origin_].y;
  const double heading = headings_[point] - headings_[origin_];
  sums_.t += sign * t;
  sums_.x += sign * x;
  sums_.y += sign * y;
  sums_.heading += sign * heading;
  sums_.tt += sign * t * t;
  sums_.tx += sign * t * x;
  sums_.ty += sign * t * y;
  sums_.xx += sign * x * x;
  sums_.yy += sign * y * y;
  sums_.heading2 += sign * heading * heading;
}

UniformMotion SlidingMotion::motion() const {
  const double n = static_cast<double>(end_ - begin_);
  const double t = sums_.t / n;
  const double x = sums_.x / n;
  const double y = sums_.y / n;
  const double heading = sums_.heading / n;
  const double tt = sums_.tt - n * t * t;
  UniformMotion motion;
  motion.time = track_[origin_].time + t;
  motion.x = track_[origin_].x + x;
  motion.y = track_[origin_].y + y;
  motion.heading = headings_[origin_] + heading;
  motion.vx = (sums_.tx - n * t * x) / tt;
  motion.vy = (sums_.ty - n * t * y) / tt;
  const double squares = sums_.xx - n * x * x + sums_.yy - n * y * y -
                         (motion.vx * motion.vx + motion.vy * motion.vy) * tt;
  motion.rms = scatterPerAxis(std::max(0.0, squares), n);
  motion.heading_rms = std::sqrt(std::max(0.0, sums_.heading2 / n - heading * heading));
  return motion;
}

}  // namespace lab::analysis
