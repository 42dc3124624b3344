/// Trajectories from a film: every picture is searched as if it were the first, and identities are
/// followed from one to the next; only a cap with one circle covered must have been seen before.
/// Knows no file and no bus.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/detector.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"

namespace lab::tracker {

/// One robot in one picture.
struct FilmRow {
  std::int64_t frame = 0;  ///< number of the picture in its film
  std::int64_t id = 0;     ///< of the track, from 1, never used again; 0: no track holds it
  double time = 0;         ///< [s] of the film
  detector::Detection pose;
};

/// What a film came to.
struct FilmSummary {
  std::int64_t frames = 0;   ///< searched
  std::int64_t missing = 0;  ///< numbers between the first and the last frame that never came
  std::int64_t rows = 0;
  std::int64_t degraded = 0;  ///< rows with a pose from one circle and the rim of the cap
  std::int64_t ids = 0;       ///< different ones
  std::int64_t surplus = 0;   ///< detections left out, as there are no more robots than were given
  std::int64_t crowded = 0;   ///< frames in which some were
  std::int64_t fewest = 0;    ///< robots in one frame
  std::int64_t most = 0;
  double confidence = 0;      ///< [1] mean over the rows
  double spacing = 0;         ///< [m] mean distance of the two circles of a robot, 0: never seen
  double spacing_spread = 0;  ///< [m] standard deviation of it
};

class FilmTracking {
 public:
  /// @param most_robots when positive, no more than the so many best of a frame are taken
  FilmTracking(detector::Detector& detector, CapTracker& tracker, std::size_t most_robots = 0)
      : detector_(detector), tracker_(tracker), most_robots_(most_robots) {}

  /// Takes the next picture.
  /// @param time [s] of the film; times that stand still or go back are taken as a new beginning a
  ///   moment later, for pictures that have nothing to do with each other
  /// @param rejected where not null, filled with what was refused
  /// @return the robots in it, by id; valid until the next call
  const std::vector<FilmRow>& take(std::int64_t number, double time,
                                   const optics::GreyView& picture,
                                   std::vector<detector::Rejection>* rejected = nullptr);

  [[nodiscard]] FilmSummary summary() const;

 private:
  void count(std::int64_t number);

  detector::Detector& detector_;
  CapTracker& tracker_;
  std::size_t most_robots_;
  std::vector<detector::Detection> found_;
  std::vector<FilmRow> rows_;
  FilmSummary total_;
  std::int64_t next_number_ = 0;
  double tracker_time_ = 0;  ///< [s] which only goes forward
  std::int64_t highest_id_ = 0;
  double confidences_ = 0;
  std::int64_t spacings_ = 0;
  double spacing_mean_ = 0;     ///< running mean [m]
  double spacing_squares_ = 0;  ///< sum of squared deviations from it [m^2]
};

/// The first line of a file of poses, with its line end.
[[nodiscard]] std::string_view filmCsvHeader();

/// One line of it: frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s; (u, v) is where the robot's
/// axis appears at the height of its cap [px].
[[nodiscard]] std::string filmCsvLine(const FilmRow& row);

}  // namespace lab::tracker
