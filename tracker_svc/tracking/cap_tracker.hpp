/// From detections to robots: which cap is which, picture after picture. Knows no picture.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracker_svc/detector.hpp"
#include "tracker_svc/tracking/assignment.hpp"
#include "tracker_svc/tracking/binding.hpp"
#include "tracker_svc/tracking/motion.hpp"

namespace lab::tracker {

/// What a robot says its wheels do.
struct WheelReport {
  std::int32_t robot_id = 0;
  double time = 0;   ///< [s] when it was sampled, on the clock of the pictures
  double left = 0;   ///< [m/s]
  double right = 0;  ///< [m/s]
};

/// One cap that is followed.
struct Track {
  std::int64_t number = 0;     ///< of this track, never used again
  std::int32_t robot_id = -1;  ///< the robot it is bound to, -1: unbound
  detector::Detection pose;    ///< of this picture, or predicted where not seen (quality 0)
  bool seen = false;           ///< in this picture
  double unseen = 0;           ///< [s] since it was last seen
};

struct TrackerSettings {
  double wheel_base = 0.075;      ///< [m]
  double max_wheel_speed = 0.27;  ///< [m/s]
  double arena_width = 1.20;      ///< [m] caps are not followed far outside
  double arena_height = 0.90;     ///< [m]
  double robot_radius = 0.0375;   ///< [m] two robots cannot be nearer than twice this
  /// Caps may be taken out and others put in, as in films of which nothing else is known: one that
  /// was missed for longer than half a second is itself only within a robot's radius, and as far as
  /// twice its speed takes it: the highest that it has shown over half a second, at least the
  /// median of all tracks' highest (a wall may have held it).
  bool caps_may_be_replaced = false;
};

struct TrackerCounts {
  std::int64_t flips = 0;    ///< head/tail flips that were detected and corrected
  std::int64_t lost = 0;     ///< tracks given up
  std::int64_t bound = 0;    ///< bindings made
  std::int64_t unbound = 0;  ///< bindings given up because they had become doubtful
};

/// Global assignment of detections to tracks with a motion model; a binding of tracks to robot ids
/// that is only as long believed as nothing else could be true.
///
/// A cap that was last seen so shortly ago that it cannot have driven half the distance of two
/// robots in contact is itself: nothing else can be there. All others are matched by likelihood,
/// all at once; whatever could be otherwise with more than kDoubt of the likelihood is doubtful:
/// the track keeps its number (the best guess) and loses its robot.
///
/// A heading that is half a turn off where the cap cannot have turned so far is a mistake of the
/// picture: it is counted, turned back, and its quality is at most 0.5. When a heading is half a
/// turn off for longer than it was right before (at most kVotes pictures), the first one was the
/// mistake.
///
/// A degraded pose (detector::kUsedRim) keeps its track alive and where it is; it begins none,
/// tells no speed, flips no heading and binds no robot.
///
/// A track binds to a robot when what the cap did fits what that robot's wheels did, and fits no
/// other free robot and no other free track: a robot that turns on the spot while the others stand
/// is the clearest case. It takes pictures at least every 0.35 s. When two tracks could have been
/// exchanged (both unseen while near to each other, ...) both become unbound until their motion
/// tells which is which.
class CapTracker {
 public:
  CapTracker(const TrackerSettings& settings, std::vector<std::int32_t> robot_ids);
  ~CapTracker();
  CapTracker(const CapTracker&) = delete;
  CapTracker& operator=(const CapTracker&) = delete;

  /// Takes what robots say; reports may come late, up to a second after the picture they belong to.
  void take(std::span<const WheelReport> wheels);

  /// Where to look for the caps in a picture taken at `time` [s], one place for every track in the
  /// order of the last update: wherever wheels can have taken it, but not more than a robot's
  /// radius unless it is lost (unseen for half a second), and then 0.15 m.
  [[nodiscard]] const std::vector<detector::Expected>& expect(double time);

  /// Takes the detections of the picture taken at `time` [s], later than the one before. Those of
  /// quality 0 are none.
  /// @return every track, valid until the next call
  const std::vector<Track>& update(double time, std::span<const detector::Detection> detections);

  /// Binds the track whose cap is nearest to a known place, as at a start from known poses.
  /// @return whether there is one within `reach` [m]
  bool bind(std::int32_t robot_id, double x, double y, double reach);

  [[nodiscard]] const TrackerCounts& counts() const { return counts_; }

  /// Natural logarithm: 10000 to 1.
  static constexpr double kDoubt = 9.2;
  static constexpr int kVotes = 30;
  /// [s] A track that is not seen for so long is given up; one that was seen only shortly, sooner.
  static constexpr double kGiveUp = 5;

 private:
  struct TrackState;

  void clean(std::span<const detector::Detection> detections);
  void matchSure(double time);
  void matchRest(double time);
  void see(TrackState& follow, double time, detector::Detection detection);
  void correctFlip(TrackState& follow, double time, detector::Detection& detection);
  void miss(TrackState& follow, double time, bool lit);
  void start(double time, const detector::Detection& detection);
  void giveUp(double time);
  void doubt(TrackState& follow);
  void compareMotion(double time);
  [[nodiscard]] bool isTouching(const TrackState& follow) const;
  void publish(double time);
  [[nodiscard]] Reckoning reckon(const TrackState& follow, double time);
  [[nodiscard]] double reachOf(double unseen) const;
  [[nodiscard]] double returnOf(const TrackState& follow, double time, double usual) const;
  [[nodiscard]] double usualSpeed() const;
  [[nodiscard]] double turnOf(double unseen) const;

  TrackerSettings settings_;
  MotionBinding binding_;
  DeadReckoner reckoner_;
  Assignment assignment_;
  std::vector<TrackState> track_states_;
  std::vector<Track> tracks_;
  std::vector<detector::Expected> expected_;
  std::vector<detector::Detection> found_;  ///< of this picture
  std::vector<int> cap_of_;  ///< index into track_states_ for each of them, -1: none yet
  std::vector<IdentityEvidence*> evidence_;
  std::int64_t next_number_ = 1;
  double lit_ = 0;  ///< [s] when caps were last seen
  TrackerCounts counts_;
};

}  // namespace lab::tracker
