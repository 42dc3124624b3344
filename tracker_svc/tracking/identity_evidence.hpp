/// Evidence that a cap is a certain robot: its motion compared with the robot's wheels, and with
/// the motion of caps that belong to no robot.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "robot/dynamics/kinematics.hpp"
#include "tracker_svc/tracking/motion.hpp"
#include "tracker_svc/tracking/wheel_log.hpp"

namespace lab::tracker {

/// Motion of a cap in one slice of time.
struct SliceMotion {
  std::int64_t slice = -1;  ///< number of the slice, -1 if none
  Wheels travel;            ///< [m] of the wheels under the cap
  Wheels before;            ///< [m] expected at the speeds of the previous slice
  double duration = 0;      ///< [s]
  double variance = 0;      ///< [m^2] of each travel, from the detections
  double foreign = 0;       ///< [ln 1/m^2] density if the cap belongs to no robot
  /// [ln] likelihood of constant speeds over that of this motion, as a loss
  double speed_change_log_ratio = 0;
  /// whether a wall or another cap is so close that it may have been held up
  bool touching = false;
};

/// Prior over wheel motion, from recent reports of all robots.
class MotionPrior {
 public:
  /// Adds the motion of the robots in a slice.
  void add(std::span<const WheelPath> paths, double duration);

  /// Density [1/m^2] of wheel travels at new speeds of any robot: a mixture of recent speeds of
  /// robots, a normal distribution with their moments, and anything wheels can do.
  [[nodiscard]] double density(const Wheels& travel, double variance, double duration,
                               double fastest) const;

  /// Probability that an unidentified cap changes its speeds in this slice: as often as robots do
  /// on average, or as many as do so now, because programs that start together change together.
  [[nodiscard]] double changes() const { return std::max(changes_ / slices_, together_); }

 private:
  void addNormal(const WheelPath& path, double duration);
  [[nodiscard]] double normalDensity(const Wheels& travel, double variance, double duration) const;

  std::vector<Wheels> samples_;  ///< [m/s] of the last seconds
  std::size_t next_sample_ = 0;
  std::size_t next_robot_ = 0;
  double weight_ = 0;
  double left_ = 0;  ///< sums of speeds and of their products
  double right_ = 0;
  double left_left_ = 0;
  double left_right_ = 0;
  double right_right_ = 0;
  /// number of slices with changed speeds, and of all slices, with a weak prior
  double changes_ = 1;
  double slices_ = 20;
  double together_ = 0;  ///< share of the robots that changed speeds in this slice, minus one robot
};

/// Log likelihood ratio of a cap's motion under one robot's wheels to that of a foreign cap, which
/// keeps its speeds or changes to speeds typical of robots.
///
/// The gain of each wheel is unknown but constant and is integrated out; otherwise equal speeds
/// over a long time would count as new evidence again and again. A robot in contact may stand still
/// or be slower than its wheels (stalled). A cap that moves differently from a robot's wheels is
/// very unlikely to be this robot, but not impossible: hands and other robots may push it.
class PairEvidence {
 public:
  /// @param highest upper limit of the evidence
  void add(const SliceMotion& cap, const WheelPath& robot, double highest);

  [[nodiscard]] double value() const { return value_; }

  /// Whether the cap moved in the last slice as the robot's wheels hardly can.
  [[nodiscard]] bool isPushed() const { return pushed_; }

  /// Lower limit, so that the evidence can recover.
  static constexpr double kLowest = -30;

 private:
  /// The cap driven by the robot's wheels, compared with a foreign cap.
  struct Driven {
    double value = 0;  ///< [ln]
    double error = 0;  ///< [ln] part of `value`, gains unknown
    Wheels travel;     ///< [m] expected
    Wheels variance;   ///< [m^2] of it, without the gains
  };
  [[nodiscard]] static Driven compare(const SliceMotion& cap, const Wheels& travel,
                                      const Wheels& variance);
  [[nodiscard]] double heldUp(const SliceMotion& cap, const WheelPath& robot,
                              double variance) const;
  void addDriven(const SliceMotion& cap, const Driven& driven);
  void sum(double highest);

  double rest_ = 0;
  double value_ = 0;
  double left_uu_ = 0;  ///< sums of travel^2 / variance and travel * error / variance, for the gain
  double left_ue_ = 0;
  double right_uu_ = 0;
  double right_ue_ = 0;
  bool stalled_ = false;
  bool pushed_ = false;
};

/// What is known about one cap's identity.
struct IdentityEvidence {
  int robot = -1;                   ///< index of the robot it is bound to, -1 if unbound
  std::vector<PairEvidence> pairs;  ///< one per robot
  std::array<SliceMotion, 16> motions;
  bool placed = false;    ///< whether it is detected in the current picture
  dynamics::Pose place;   ///< its pose there
  double variance = 0;    ///< [m^2] of a wheel's position there
  bool touching = false;  ///< whether a wall or another cap is next to it there
  bool begun = false;     ///< whether it was detected at the start of the slice
  dynamics::Pose begin;   ///< its pose there
  double begin_variance = 0;
  bool begin_touching = false;
  Wheels speeds;  ///< [m/s] in the last slice
  /// [ln] loss of likelihood by a change of speeds in the last slice
  double speed_change_log_ratio = 0;
  int candidate = -1;    ///< robot that it is about to be bound to
  int confirmed = 0;     ///< number of slices that confirmed it
  bool proven = false;   ///< bound manually, or beyond doubt since
  bool suspect = false;  ///< moves differently from its robot
  int contrary = 0;      ///< number of slices in which it did

  /// Discards all evidence: the cap may be another one.
  void forget();
};

}  // namespace lab::tracker
