/// What one robot said its wheels did, in the order of time, whatever order it came in.
#pragma once

#include <vector>

namespace lab::tracker {

/// Both wheels' ways over some time: what they rolled [m], and how well that is known [m^2].
struct WheelPath {
  bool known = false;    ///< reports cover all of it
  bool changed = false;  ///< the speeds changed in it
  double left = 0;
  double right = 0;
  double left_variance = 0;
  double right_variance = 0;
  double first_left = 0;  ///< [m] had the speeds at the beginning lasted
  double first_right = 0;
  double last_left = 0;  ///< [m] had those of the end been there from the beginning
  double last_right = 0;
};

/// A stretch of time in which both wheels kept about one speed.
struct WheelSegment {
  double begin = 0;  ///< [s]
  double end = 0;
  double left = 0;  ///< [m/s]
  double right = 0;
  double left_from = 0;  ///< [m/s] as reported before it
  double right_from = 0;
  double left_step = 0;  ///< [m/s] by how much the speed changed somewhere in it
  double right_step = 0;
};

class WheelLog {
 public:
  /// Reports may be late and out of order; one for a time that is known already is ignored.
  void add(double time, double left, double right);

  /// Drops what is older than needed.
  void forgetBefore(double time);

  [[nodiscard]] bool isEmpty() const { return reports_.empty(); }
  /// Of the newest report; only where there is one.
  [[nodiscard]] double latest() const { return reports_.back().time; }

  /// What is known of [begin, end], in order; gaps between reports of more than kLongestGap and
  /// what lies before the first or behind the last report are left out.
  void segments(double begin, double end, std::vector<WheelSegment>& out) const;

  /// The wheels' ways from begin to end, with the errors of real wheels and of the reports' times.
  [[nodiscard]] WheelPath path(double begin, double end) const;

  /// The random part of the error [m^2] of a wheel's way in some time.
  [[nodiscard]] static double randomVariance(double travel, double duration) {
    return kRandomWay * kRandomWay * duration + kRandomGain * kRandomGain * travel * travel;
  }

  /// [s] Over longer gaps between two reports nothing is assumed.
  static constexpr double kLongestGap = 0.3;
  /// [m/sqrt(s)] Random way of one wheel: 0.6 mm in 0.1 s.
  static constexpr double kRandomWay = 2e-3;
  /// [1] Random relative error of one wheel's speed over a tenth of a second.
  static constexpr double kRandomGain = 0.03;
  /// [m/s] What is less is no change of a speed.
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
