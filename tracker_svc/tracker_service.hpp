/// The tracker as a service: reads the camera, publishes TRACKED_FRAME.
#pragma once

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "common/service/service_main.hpp"
#include "tracker_svc/calibration/spacing_check.hpp"
#include "tracker_svc/cameras/run_filmer.hpp"
#include "tracker_svc/detector/picture_check.hpp"
#include "tracker_svc/detector/sync_reader.hpp"
#include "tracker_svc/marker_detector.hpp"
#include "tracker_svc/response_finder.hpp"
#include "tracker_svc/tracking/latency.hpp"
#include "tracker_svc/tracking/marker_tracker.hpp"
#include "tracker_svc/views/debug_output.hpp"

namespace lab::tracker {

/// Publishes TRACKED_FRAME (markers bound to robots, and unidentified ones) and TRACKED_DETAILS for
/// every picture, and TRACKER_STATUS, which includes a continuous check of the calibration.
///
/// Searches near expected caps. Once a second, and whenever a cap is missing, it searches the whole
/// picture; both give the same poses. ROBOT_STATUS reports the wheel motion of each robot. The
/// comparison with the motion of the caps tells which cap is which robot. Tags have the ids of
/// robots; blobs remain unidentified.
///
/// A second tracker in the same lab stays silent and reports that.
class TrackerService final : public Service {
 public:
  /// @throws ExperimentError if the calibration cannot be read or is for another picture size.
  /// @throws CameraError if the camera cannot be used.
  explicit TrackerService(const ServiceContext& context);

 private:
  void handle(const robot_status_t& status);
  void handle(const CameraFrame& frame);
  void findResponse(const optics::GreyView& picture);
  void readSync(const CameraFrame& frame, std::int64_t utime);
  void trouble(const std::string& what);
  void ended(const std::string& problem);
  const std::vector<Track>& track(const CameraFrame& frame, double time, std::int64_t now,
                                  const Exposure& exposure);
  void film(const CameraFrame& frame, std::int64_t utime, std::int64_t arrived);
  void publish(const CameraFrame& frame, std::int64_t utime, const std::vector<Track>& tracks);
  void report();
  void warn(const std::string& what);
  void watchOtherTracker(const tracked_frame_t& frame);
  [[nodiscard]] double seconds(std::int64_t utime) const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  CameraCalibration calibration_;
  detector::MarkerSettings markers_;
  std::unique_ptr<detector::MarkerDetector> detector_;
  std::optional<detector::ResponseFinder> response_;  ///< while the camera's response is not known
  double gamma_;                                      ///< assumed until then
  std::unique_ptr<MarkerTracker> tracker_;
  calibration::SpacingCheck spacing_;
  PictureCheck pictures_;
  BlindCheck blind_;
  std::optional<SyncReader> sync_;  ///< if the projector shows a sync patch
  Latency latency_;
  std::unique_ptr<DebugOutput> debug_;
  std::optional<cameras::RunFilmer> film_;  ///< of the run, if it is wanted
  std::unique_ptr<FrameSource> source_;

  std::size_t robots_ = 0;       ///< number of robots in the experiment
  std::int8_t origin_;           ///< as in robot_state_t: of the camera
  std::int64_t origin_utime_;    ///< utime of the tracker's time 0
  std::int64_t file_utime_ = 0;  ///< utime of a recording's first frame on this host
  std::int64_t last_utime_ = 0;
  std::int64_t next_search_ = 0;
  bool all_detected_ = false;
  bool searched_ = false;             ///< the whole of the last picture was searched at first
  std::int64_t status_instance_ = 0;  ///< of the last ROBOT_STATUS
  std::int64_t status_seq_ = 0;
  std::int64_t other_until_;  ///< until then another tracker may be alive
  bool silent_ = false;       ///< because of another tracker
  tracker_status_t status_{};
  std::vector<WheelReport> wheels_;
};

/// The service as a process, or inside a process that runs the whole lab.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::tracker
