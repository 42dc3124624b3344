/// Tracks caps from picture to picture and binds tracks to robots. Uses detections only, no
/// pictures.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracker_svc/detector.hpp"
#include "tracker_svc/tracking/assignment.hpp"
#include "tracker_svc/tracking/binding.hpp"
#include "tracker_svc/tracking/marker_tracker.hpp"
#include "tracker_svc/tracking/motion.hpp"

namespace lab::tracker {

struct TrackerSettings {
  double wheel_base = 0.075;      ///< [m]
  double max_wheel_speed = 0.27;  ///< [m/s]
  double arena_width = 1.20;      ///< [m] caps are not tracked far outside
  double arena_height = 0.90;     ///< [m]
  double robot_radius = 0.0375;   ///< [m] two axes cannot be closer than twice this
  /// Whether caps may be removed and others added, as in recordings without further information. A
  /// cap missing for more than half a second then counts as the same only within a robot's radius,
  /// and within the distance at twice its speed: its own highest mean speed over half a second, but
  /// at least the median over all tracks (a wall may have held it).
  bool caps_may_be_replaced = false;
};

/// Assigns detections to tracks globally, with a motion model, and binds tracks to robot ids as
/// long as no alternative is likely.
///
/// A cap whose last detection is so recent that it cannot have driven half the distance of two
/// robots in contact is assigned directly: no other cap can be there. All others are assigned by
/// likelihood, jointly. If an alternative assignment is likelier than exp(-kDoubt), the track is
/// doubtful: it keeps its number (the best estimate) but loses its robot.
///
/// A heading that is reversed although the cap cannot have turned so far is a detection error: it
/// is counted and corrected, and its quality is at most 0.5. If a heading stays reversed for longer
/// than it was right before (at most kVotes pictures), the first heading was the error.
///
/// A degraded pose (detector::kUsedRim) keeps a track alive and updates its place. It starts no
/// track, and is not used for speeds, flips or binding.
///
/// A track is bound to a robot when its motion fits that robot's wheel motion, and no other free
/// robot and no other free track fits as well; the clearest case is a robot that turns on the spot
/// while the others stand. This needs pictures at least every 0.35 s. If two tracks may have been
/// exchanged (for example both undetected while close together), both are unbound until their
/// motion identifies them.
class CapTracker final : public MarkerTracker {
 public:
  CapTracker(const TrackerSettings& settings, std::vector<std::int32_t> robot_ids);
  ~CapTracker() override;

  void addReports(std::span<const WheelReport> wheels) override;

  /// Caps are expected as far away as their wheels allow, but at most a robot's radius, or 0.15 m
  /// if the track is lost (undetected for half a second).
  [[nodiscard]] const std::vector<detector::Expected>& expect(double time) override;

  const std::vector<Track>& update(double time,
                                   std::span<const detector::Detection> detections) override;

  /// Binds the track whose cap is nearest to a known place, as for a start from known poses.
  /// @return whether there is one within `reach` [m]
  bool bind(std::int32_t robot_id, double x, double y, double reach);

  [[nodiscard]] const TrackerCounts& counts() const override { return counts_; }

  /// [ln] 10000 to 1.
  static constexpr double kDoubt = 9.2;
  static constexpr int kVotes = 30;
  /// [s] A track without detection for this time is given up; one with few detections sooner.
  static constexpr double kGiveUp = 5;

 private:
  struct TrackState;

  void clean(std::span<const detector::Detection> detections);
  void matchSure(double time);
  void matchRest(double time);
  void noteDetected(TrackState& track, double time, detector::Detection detection);
  void correctFlip(TrackState& track, double time, detector::Detection& detection);
  void noteUndetected(TrackState& track, double time, bool lit);
  void start(double time, const detector::Detection& detection);
  void giveUp(double time);
  void doubt(TrackState& track);
  void compareMotion(double time);
  [[nodiscard]] bool isTouching(const TrackState& track) const;
  void publish(double time);
  [[nodiscard]] Reckoning reckon(const TrackState& track, double time);
  [[nodiscard]] double reachOf(double elapsed) const;
  [[nodiscard]] double returnOf(const TrackState& track, double time, double usual) const;
  [[nodiscard]] double usualSpeed() const;
  [[nodiscard]] double turnOf(double elapsed) const;

  TrackerSettings settings_;
  MotionBinding binding_;
  DeadReckoner reckoner_;
  Assignment assignment_;
  std::vector<TrackState> track_states_;
  std::vector<Track> tracks_;
  std::vector<detector::Expected> expected_;
  std::vector<detector::Detection> found_;  ///< of this picture
  std::vector<int> cap_of_;                 ///< by detection: index into track_states_, -1 if none
  std::vector<IdentityEvidence*> evidence_;
  std::int64_t next_number_ = 1;
  double lit_ = 0;  ///< [s] time of the last detection of any cap
  TrackerCounts counts_;
};

}  // namespace lab::tracker
