/// Trajectories from a recording. Every picture is searched completely; the tracker assigns
/// detections to tracks. Only caps with one covered circle need an earlier detection. Uses no files
/// and no bus.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/marker_detector.hpp"
#include "tracker_svc/tracking/marker_tracker.hpp"

namespace lab::tracker {

/// One robot in one picture.
struct FilmRow {
  std::int64_t frame = 0;  ///< number of the picture in the recording
  std::int64_t id = 0;     ///< of the track, from 1, never reused; 0 if it belongs to no track
  double time = 0;         ///< [s] since the start of the recording
  detector::Detection pose;
  double swap = 0;  ///< [1] probability that it is not the marker of the row before; only of blobs
};

/// Totals over a recording.
struct FilmSummary {
  std::int64_t frames = 0;   ///< number of frames searched
  std::int64_t missing = 0;  ///< frame numbers between the first and the last that did not occur
  std::int64_t rows = 0;
  std::int64_t degraded = 0;  ///< rows with a pose from one circle and the rim of the cap
  std::int64_t ids = 0;       ///< number of different ids
  std::int64_t surplus =
      0;  ///< detections left out, beyond the number of robots or kMostDetections
  std::int64_t crowded = 0;  ///< frames with surplus detections
  std::int64_t fewest = 0;   ///< fewest robots in one frame
  std::int64_t most = 0;
  std::int64_t merged = 0;    ///< rows of several blobs that were not split
  double swaps = 0;           ///< expected number of swaps of identities
  std::int64_t doubtful = 0;  ///< rows whose probability of a swap is above kDoubtful
  double confidence = 0;      ///< [1] mean over the rows
  double spacing = 0;         ///< [m] mean spacing of the two circles of a cap, 0 if never measured
  double spacing_spread = 0;  ///< [m] its standard deviation
};

class FilmTracking {
 public:
  /// Detections of a frame that are used, best first: noise may show a hundred thousand, and the
  /// tracker compares each with each track.
  static constexpr std::size_t kMostDetections = 10'000;

  /// @param most_robots if positive, at most this many detections of a frame are used, best first
  FilmTracking(detector::MarkerDetector& detector, MarkerTracker& tracker,
               std::size_t most_robots = 0)
      : detector_(detector),
        tracker_(tracker),
        most_used_(most_robots > 0 ? most_robots : kMostDetections) {}

  /// Processes the next picture.
  /// @param time [s] since the start of the recording; if times repeat or go back, as for unrelated
  ///   pictures, tracking starts anew a moment later
  /// @param rejected if not null, receives the rejected candidates
  /// @return the robots in it, by id; valid until the next call
  const std::vector<FilmRow>& process(std::int64_t number, double time,
                                      const optics::GreyView& picture,
                                      std::vector<detector::Rejection>* rejected = nullptr);

  [[nodiscard]] FilmSummary summary() const;

  /// [1] Probability of a swap above which a row is doubtful.
  static constexpr double kDoubtful = 0.05;

 private:
  void count(std::int64_t number);

  detector::MarkerDetector& detector_;
  MarkerTracker& tracker_;
  std::size_t most_used_;
  std::vector<detector::Detection> found_;
  std::vector<FilmRow> rows_;
  FilmSummary total_;
  std::int64_t next_number_ = 0;
  double tracker_time_ = 0;  ///< [s] increases monotonically
  std::set<std::int64_t> ids_;
  double confidences_ = 0;
  std::int64_t spacings_ = 0;
  double spacing_mean_ = 0;     ///< running mean [m]
  double spacing_squares_ = 0;  ///< sum of squared deviations from it [m^2]
};

/// The header line of a file of poses, with its line end.
[[nodiscard]] std::string_view filmCsvHeader(
    detector::MarkerKind kind = detector::MarkerKind::kCaps);

/// One line of a file of poses: frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s. (u, v) is the
/// image of the robot's axis at cap height, or of the marker's centre [px]; theta_rad is empty if
/// the marker has no heading. Blobs have the further columns
/// area_cm2,length_cm,width_cm,merged,swap, tags the column tag.
[[nodiscard]] std::string filmCsvLine(const FilmRow& row,
                                      detector::MarkerKind kind = detector::MarkerKind::kCaps);

}  // namespace lab::tracker
