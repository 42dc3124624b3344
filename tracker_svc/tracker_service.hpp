/// The tracker on the bus: a camera's pictures in, TRACKED_FRAME out.
#pragma once

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "common/service/service_main.hpp"
#include "tracker_svc/calibration/spacing_check.hpp"
#include "tracker_svc/detector.hpp"
#include "tracker_svc/detector/picture_check.hpp"
#include "tracker_svc/detector/sync_reader.hpp"
#include "tracker_svc/response_finder.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"
#include "tracker_svc/tracking/latency.hpp"
#include "tracker_svc/views/debug_output.hpp"

namespace lab::tracker {

/// Publishes, for every picture, TRACKED_FRAME (each cap that is bound to a robot, and the others
/// as unidentified) and TRACKED_DETAILS; and TRACKER_STATUS, with the standing check of the
/// calibration.
///
/// Looks where caps are expected, and through the whole picture once a second and whenever one is
/// missing; both find the same. ROBOT_STATUS tells what the robots' wheels do, from which the
/// tracker knows which cap is which.
///
/// A second tracker on the same lab keeps silent and says so.
class TrackerService final : public Service {
 public:
  /// @throws ExperimentError when the calibration cannot be read or is of other pictures.
  /// @throws CameraError when the camera cannot be used.
  explicit TrackerService(const ServiceContext& context);

 private:
  void take(const robot_status_t& status);
  void take(const CameraFrame& frame);
  void findResponse(const optics::GreyView& picture);
  void readSync(const CameraFrame& frame, std::int64_t utime);
  void trouble(const std::string& what);
  void ended(const std::string& problem);
  const std::vector<Track>& track(const optics::GreyView& picture, double time,
                                  const Exposure& exposure);
  void publish(const CameraFrame& frame, std::int64_t utime, const std::vector<Track>& tracks);
  void report();
  void warn(const std::string& what);
  void watchOtherTracker(const tracked_frame_t& frame);
  [[nodiscard]] double seconds(std::int64_t utime) const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  CameraCalibration calibration_;
  detector::Detector detector_;
  std::optional<detector::ResponseFinder> response_;  ///< while the camera's response is not known
  double gamma_;                                      ///< that is believed meanwhile
  CapTracker tracker_;
  calibration::SpacingCheck spacing_;
  PictureCheck pictures_;
  BlindCheck blind_;
  std::optional<SyncReader> sync_;  ///< where the projector shows a sync patch
  Latency latency_;
  std::unique_ptr<DebugOutput> debug_;
  std::unique_ptr<FrameSource> source_;

  std::size_t robots_ = 0;       ///< that the camera should see
  std::int8_t origin_;           ///< robot_state_t's, of the camera
  std::int64_t origin_utime_;    ///< of time 0 of the tracker
  std::int64_t file_utime_ = 0;  ///< host time of a film's first frame
  std::int64_t last_utime_ = 0;
  std::int64_t next_search_ = 0;
  bool all_seen_ = false;
  std::int64_t other_until_;  ///< until then another tracker may be alive
  bool silent_ = false;       ///< for its sake
  tracker_status_t status_{};
  std::vector<WheelReport> wheels_;
};

/// The service as a process or as a part of a lab in one process.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::tracker
