/// Joins the detections of several cameras to one list for the tracker. No clock, no files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "tracker_svc/fusion/pose_fusion.hpp"
#include "tracker_svc/fusion/view_comparison.hpp"

namespace lab::tracker {

/// The robots at one time, seen by all cameras together.
struct FusedRound {
  double time = 0;  ///< [s] on the clock of the first camera
  std::vector<detector::Detection> detections;
  std::vector<std::size_t> cameras;  ///< whose pictures are in it
};

struct FusionCounts {
  std::int64_t shared = 0;    ///< robots that more than one camera saw, summed over rounds
  std::int64_t rejected = 0;  ///< poses that contradicted a better one
};

/// A round has at most one picture of each camera. It ends when all living cameras have
/// contributed, or when one of them sends its next picture. Poses are freed of the differences of
/// the calibrations, moved to the time of the round with the robots' velocities and the offsets of
/// the clocks, and fused. A camera that has
/// missed kMissed rounds is not waited for until it sends a picture again.
class CameraFusion {
 public:
  explicit CameraFusion(std::size_t cameras, const FusionSettings& settings = {});

  /// Adds a picture.
  /// @param time [s] as stamped by this camera
  /// @return rounds that have ended, in order of time
  std::vector<FusedRound> add(std::size_t camera, double time,
                              std::span<const detector::Detection> detections);

  /// The camera is lost: rounds do not wait for it.
  void lose(std::size_t camera) { missed_[camera] = kMissed; }
  [[nodiscard]] bool isAlive(std::size_t camera) const { return missed_[camera] < kMissed; }

  [[nodiscard]] const std::vector<ClockOffset>& offsets() const { return offsets_; }
  /// By camera; all 0 until an offset is known.
  [[nodiscard]] const std::vector<ViewError>& errors() const { return errors_; }
  [[nodiscard]] const FusionCounts& counts() const { return counts_; }

  static constexpr int kMissed = 5;
  /// [s] An offset is applied when its standard error is below this, and so are the errors of the
  /// calibrations that follow from robots which cameras with such offsets see together.
  static constexpr double kApplied = 5e-4;

 private:
  struct Picture {
    double time = 0;
    std::vector<detector::Detection> detections;
  };
  /// A robot of the last round.
  struct Mover {
    double x = 0, y = 0, theta = 0;  ///< [m], [rad]
    double vx = 0, vy = 0;           ///< [m/s]
    double omega = 0;                ///< [rad/s]
    bool moves = false;              ///< the velocity is known
    bool steady = false;             ///< and is that of the round before
  };

  std::optional<FusedRound> finish();
  [[nodiscard]] const Mover* moverAt(double x, double y) const;
  [[nodiscard]] double offsetOf(std::size_t camera) const;
  void learn(const std::vector<FusedPose>& robots, const std::vector<Mover>& movers,
             const std::vector<Sighting>& raw, const std::vector<double>& stamps);

  FusionSettings settings_;
  std::vector<std::optional<Picture>> pictures_;
  std::vector<int> missed_;
  std::vector<Mover> movers_;
  ViewComparison comparison_;
  std::vector<ClockOffset> offsets_;
  std::vector<ViewError> errors_;
  bool compared_ = false;                                   ///< errors_ are known
  double last_ = -std::numeric_limits<double>::infinity();  ///< [s] time of the last round
  double solved_ = -std::numeric_limits<double>::infinity();
  FusionCounts counts_;
};

}  // namespace lab::tracker
