/// What speaks for a cap being a robot: its motion against the robot's wheels, and against what
/// caps do that belong to no robot.
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

/// What a cap did in one slice of time.
struct SliceMotion {
  std::int64_t slice = -1;  ///< which, -1: none
  Wheels travel;            ///< [m] of wheels under the cap
  Wheels before;            ///< [m] what it would have been at the speeds of the slice before
  double duration = 0;      ///< [s]
  double variance = 0;      ///< [m^2] of each way, from the detections
  double foreign = 0;       ///< [ln 1/m^2] density if the cap belonged to no robot
  double speed_change_log_ratio = 0;  ///< [ln] how much less than if it had kept its speeds
  bool touching = false;  ///< a wall or another cap is so near that it may have been held up
};

/// What robots do these days: what may be expected of a cap of which nothing is known.
class MotionPrior {
 public:
  /// Takes what the robots did in a slice.
  void add(std::span<const WheelPath> paths, double duration);

  /// Density [1/m^2] of ways of wheels as new speeds, drawn by any robot: as other robots were seen
  /// to drive, or normally distributed as they are, or anything wheels can do.
  [[nodiscard]] double density(const Wheels& travel, double variance, double duration,
                               double fastest) const;

  /// How likely a cap of which nothing is known changes its speeds in this slice: as often as
  /// robots do, and when others do, as programs that were started together draw together.
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
  double changes_ = 1;  ///< slices in which speeds changed, and all, with a little prejudice
  double slices_ = 20;
  double together_ = 0;  ///< share of the robots, but for one, that changed theirs in this slice
};

/// How much better (natural logarithm of the likelihood ratio) a cap's motion is explained by one
/// robot's wheels than by a cap of no robot, which goes on as it does or changes to whatever robots
/// do.
///
/// The gain of each wheel is unknown but constant and is integrated out, so that equal speeds over
/// a long time are not taken for ever new evidence. A robot in contact may stand or be slower than
/// its wheels (stalled); a cap that moves as its robot's wheels do not is nearly excluded, but not
/// quite: hands and other robots push.
class PairEvidence {
 public:
  /// @param highest what is known never counts more
  void add(const SliceMotion& cap, const WheelPath& robot, double highest);

  [[nodiscard]] double value() const { return value_; }

  /// Whether the cap did in the last slice what the robot's wheels can hardly have done.
  [[nodiscard]] bool isPushed() const { return pushed_; }

  /// It never falls lower, so that it can recover.
  static constexpr double kLowest = -30;

 private:
  /// The cap as driven by the robot's wheels: how much likelier than as a foreign one.
  struct Driven {
    double value = 0;  ///< [ln]
    double error = 0;  ///< [ln] part of it, gains unknown
    Wheels travel;     ///< [m] expected
    Wheels variance;   ///< [m^2] of it, but for the gains
  };
  [[nodiscard]] static Driven compare(const SliceMotion& cap, const Wheels& travel,
                                      const Wheels& variance);
  [[nodiscard]] double heldUp(const SliceMotion& cap, const WheelPath& robot,
                              double variance) const;
  void addDriven(const SliceMotion& cap, const Driven& driven);
  void sum(double highest);

  double rest_ = 0;
  double value_ = 0;
  double left_uu_ = 0;  ///< sums of way^2 / variance and way * error / variance, for the gain
  double left_ue_ = 0;
  double right_uu_ = 0;
  double right_ue_ = 0;
  bool stalled_ = false;
  bool pushed_ = false;
};

/// What is known of one cap's identity.
struct IdentityEvidence {
  int robot = -1;                   ///< index of the robot it is bound to, -1: unbound
  std::vector<PairEvidence> pairs;  ///< with every robot
  std::array<SliceMotion, 16> motions;
  bool placed = false;    ///< seen in the picture that is looked at
  dynamics::Pose place;   ///< there
  double variance = 0;    ///< [m^2] of a wheel's place, there
  bool touching = false;  ///< there is a wall or another cap next to it, there
  bool begun = false;     ///< seen where the slice began
  dynamics::Pose begin;   ///< there
  double begin_variance = 0;
  bool begin_touching = false;
  Wheels speeds;                      ///< [m/s] in the last slice
  double speed_change_log_ratio = 0;  ///< how unlikely a change of speeds in the last slice was
  int candidate = -1;                 ///< robot that it is about to be bound to
  int confirmed = 0;                  ///< in so many slices
  bool proven = false;                ///< bound by hand, or far beyond doubt since
  bool suspect = false;               ///< moves as its robot does not
  int contrary = 0;                   ///< slices it has done so

  /// What was known is worth nothing any more: the cap may be another one.
  void forget();
};

}  // namespace lab::tracker
