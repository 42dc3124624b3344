/// Reported wheel speeds of one robot, ordered by time.
#pragma once

#include <vector>

namespace lab::tracker {

/// Travel of both wheels over some time [m], with its variance [m^2].
struct WheelPath {
  bool known = false;    ///< whether reports cover all of it
  bool changed = false;  ///< whether the speeds changed in it
  double left = 0;
  double right = 0;
  double left_variance = 0;
  double right_variance = 0;
  double first_left = 0;  ///< [m] at the initial speeds
  double first_right = 0;
  double last_left = 0;  ///< [m] at the final speeds
  double last_right = 0;
};

/// An interval with about constant speeds of both wheels.
struct WheelSegment {
  double begin = 0;  ///< [s]
  double end = 0;
  double left = 0;  ///< [m/s]
  double right = 0;
  double left_from = 0;  ///< [m/s] reported before it
  double right_from = 0;
  double left_step = 0;  ///< [m/s] change of the speed at an unknown instant in it
  double right_step = 0;
};

class WheelLog {
 public:
  /// Reports may arrive late and out of order. A second report for the same time is ignored.
  void add(double time, double left, double right);

  /// Drops reports that are no longer needed.
  void forgetBefore(double time);

  [[nodiscard]] bool isEmpty() const { return reports_.empty(); }
  /// [s] of the newest report; requires one.
  [[nodiscard]] double latest() const { return reports_.back().time; }

  /// The intervals known within [begin, end], in order. Gaps between reports longer than
  /// kLongestGap, and times before the first or after the last report, are omitted.
  void segments(double begin, double end, std::vector<WheelSegment>& out) const;

  /// Wheel travels from begin to end, with the errors of real wheels and of report times.
  [[nodiscard]] WheelPath path(double begin, double end) const;

  /// Random variance [m^2] of a wheel's travel over some time.
  [[nodiscard]] static double randomVariance(double travel, double duration) {
    return kRandomWay * kRandomWay * duration + kRandomGain * kRandomGain * travel * travel;
  }

  /// [s] Longer gaps between reports are not interpolated.
  static constexpr double kLongestGap = 0.3;
  /// [m/sqrt(s)] Random walk of one wheel: 0.6 mm in 0.1 s.
  static constexpr double kRandomWay = 2e-3;
  /// [1] Random relative error of one wheel's speed over a tenth of a second.
  static constexpr double kRandomGain = 0.03;
  /// [m/s] Smaller changes of a speed are ignored.
  static constexpr double kSpeedStep = 0.01;
  /// [s] Error of the time of a report against the pictures.
  static constexpr double kTimeError = 0.025;

 private:
  struct Report {
    double time = 0;
    double left = 0;
    double right = 0;
  };
  std::vector<Report> reports_;
};

}  // namespace lab::tracker
