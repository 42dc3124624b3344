/// Identifies robots by motion: compares the motion of caps with the reported wheel motion.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "tracker_svc/tracking/assignment.hpp"
#include "tracker_svc/tracking/identity_evidence.hpp"
#include "tracker_svc/tracking/motion.hpp"
#include "tracker_svc/tracking/wheel_log.hpp"

namespace lab::tracker {

/// Compares motions in slices of a tenth of a second. Binds a cap to a robot when every alternative
/// is less likely by exp(kBindRatio): any other assignment of caps to robots, a cap of no robot,
/// and a robot whose cap is not in view.
class MotionBinding {
 public:
  MotionBinding(const MotionSettings& settings, std::vector<std::int32_t> robot_ids);

  void addReport(std::int32_t robot_id, double time, double left, double right);

  [[nodiscard]] std::size_t robots() const { return ids_.size(); }
  /// -1 if there is no such robot.
  [[nodiscard]] int indexOf(std::int32_t robot_id) const;
  [[nodiscard]] std::int32_t idOf(int robot) const {
    return robot < 0 ? -1 : ids_[static_cast<std::size_t>(robot)];
  }
  /// Null for -1.
  [[nodiscard]] const WheelLog* logOf(int robot) const {
    return robot < 0 ? nullptr : &logs_[static_cast<std::size_t>(robot)];
  }

  /// Whether a picture at this time ends the slice.
  [[nodiscard]] bool isDue(double time) const;

  /// Ends the slice, evaluates the reports, binds and unbinds.
  void step(double time, std::span<IdentityEvidence* const> caps);

  [[nodiscard]] std::int64_t bound() const { return bound_; }
  [[nodiscard]] std::int64_t unbound() const { return unbound_; }

  /// [ln] A wrong binding must be 100000 times less likely than the right one.
  static constexpr double kBindRatio = 11.5;
  /// [ln] Prior odds that a cap is a robot in view rather than a foreign cap beside a robot out of
  /// view: 400 to 1; with more caps than reporting robots 3 to 1.
  static constexpr double kLogPriorOwnRobot = 6;
  static constexpr double kLogPriorOwnRobotAmongMore = 1.1;
  /// Consecutive slices that must agree.
  static constexpr int kConfirm = 3;

 private:
  struct Slice {
    std::int64_t number = 0;
    double begin = 0;
    double end = 0;
  };
  void measure(double time, std::span<IdentityEvidence* const> caps);
  [[nodiscard]] bool isReady(const Slice& slice, double time) const;
  [[nodiscard]] double prior(std::span<IdentityEvidence* const> caps) const;
  void expectOfForeign(IdentityEvidence& cap, SliceMotion& motion, double fastest) const;
  void weigh(const Slice& slice, std::span<IdentityEvidence* const> caps);
  void doubt(std::span<IdentityEvidence* const> caps);
  void bindFree(std::span<IdentityEvidence* const> caps);
  void bindTo(IdentityEvidence& cap, std::size_t robot);
  void unbind(IdentityEvidence& cap);

  MotionSettings settings_;
  std::vector<std::int32_t> ids_;
  std::vector<WheelLog> logs_;
  std::vector<WheelPath> paths_;
  std::vector<IdentityEvidence*> bound_caps_;  ///< by robot: the cap bound to it
  std::deque<Slice> slices_;                   ///< not evaluated yet
  std::int64_t next_slice_ = 0;
  double slice_begin_ = 0;
  double prior_ = kLogPriorOwnRobot;  ///< [ln] for each pair, added to its evidence
  bool started_ = false;
  MotionPrior motion_prior_;
  Assignment assignment_;
  std::vector<IdentityEvidence*> free_caps_;
  std::vector<std::size_t> free_robots_;
  std::int64_t bound_ = 0;
  std::int64_t unbound_ = 0;
};

}  // namespace lab::tracker
