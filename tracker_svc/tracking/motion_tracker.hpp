/// Tracks markers that look alike by their motion alone, and says how probable a swap of
/// identities is.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracker_svc/tracking/assignment.hpp"
#include "tracker_svc/tracking/link_probabilities.hpp"
#include "tracker_svc/tracking/marker_tracker.hpp"

namespace lab::tracker {

struct MotionTrackerSettings {
  double step = 0.005;   ///< [m] typical distance from picture to picture, until it is learnt
  double max_speed = 0;  ///< [m/s] no marker is faster; 0: not known
  double area = 1.08;    ///< [m^2] in which markers may appear
  double patience = 1;   ///< [s] after which a marker that is not seen gets a new number
};

/// The motion of markers from picture to picture, learnt from all of them. A step is expected to be
/// `persistence` times the last one; the rest is random: normal, with a few steps three times as
/// wide. Brownian motion has persistence 0, straight motion 1.
struct StepModel {
  double persistence = 0;  ///< [1]
  double variance = 0;     ///< [m^2] of the rest, per axis, from one picture to the next
  double first = 0;        ///< [m^2] of a step without an earlier one, per axis
  double interval = 0;     ///< [s] between pictures
};

/// Assigns detections to tracks by likelihood, jointly for all markers near each other.
///
/// Every detection of a track has a probability that it is another marker than the one of the
/// detection before: the sum over all other assignments, weighted with their likelihoods
/// (LinkProbabilities). It is honest as far as the steps follow StepModel. It is large where
/// markers move farther between pictures than they are apart, or were hidden near each other.
///
/// The model is learnt from all possible links, each with its probability (expectation
/// maximisation), so that it is not biased towards short steps.
class MotionTracker final : public MarkerTracker {
 public:
  explicit MotionTracker(const MotionTrackerSettings& settings);
  ~MotionTracker() override;

  [[nodiscard]] const std::vector<detector::Expected>& expect(double time) override;

  /// Detections of several markers that were not split (Detection::merged) belong to no track. The
  /// axis of a blob becomes a heading: the direction nearest to the one before, reversed if the
  /// marker keeps moving backwards.
  const std::vector<Track>& update(double time,
                                   std::span<const detector::Detection> detections) override;

  [[nodiscard]] const TrackerCounts& counts() const override { return counts_; }
  [[nodiscard]] const StepModel& model() const { return model_; }

 private:
  struct TrackState;
  /// Where a track is expected, per axis.
  struct Prediction {
    double x = 0;         ///< [m]
    double y = 0;         ///< [m]
    double variance = 0;  ///< [m^2]
    double steps = 1;     ///< pictures since its last detection
  };

  [[nodiscard]] Prediction predict(const TrackState& track, double time) const;
  void findLinks(double time);
  void learn(double time);
  void assign();
  void noteDetected(TrackState& track, double time, const detector::Detection& detection);
  void direct(TrackState& track, detector::Detection& detection, double dx, double dy) const;
  void publish(double time);

  MotionTrackerSettings settings_;
  StepModel model_;
  // Sums of the steps that were learnt, older ones with less weight.
  double first_weight_ = 0;
  double first_square_ = 0;  ///< [m^2]
  double weight_ = 0;
  double square_ = 0;   ///< [m^2]
  double product_ = 0;  ///< [m^2] of successive steps
  double before_ = 0;   ///< [m^2] of the earlier ones
  double news_ = 0;     ///< markers that appeared
  std::int64_t pictures_ = 0;
  double last_time_ = 0;

  Assignment assignment_;
  LinkProbabilities probabilities_;
  std::vector<Link> links_;
  std::vector<double> link_probabilities_;
  std::vector<Prediction> predictions_;
  std::vector<TrackState> states_;
  std::vector<detector::Detection> found_;
  std::vector<int> chosen_;   ///< by track: detection, -1 if none
  std::vector<double> swap_;  ///< by track
  std::vector<Track> tracks_;
  std::vector<detector::Expected> expected_;
  std::int64_t next_number_ = 1;
  TrackerCounts counts_;
};

}  // namespace lab::tracker
