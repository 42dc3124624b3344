/// The tracker of several cameras with overlapping views: publishes one TRACKED_FRAME for all.
#pragma once

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "common/service/service_main.hpp"
#include "tracker_svc/calibration/spacing_check.hpp"
#include "tracker_svc/cameras/run_filmer.hpp"
#include "tracker_svc/detector/sync_reader.hpp"
#include "tracker_svc/fusion/camera_fusion.hpp"
#include "tracker_svc/marker_detector.hpp"
#include "tracker_svc/response_finder.hpp"
#include "tracker_svc/tracking/latency.hpp"
#include "tracker_svc/tracking/marker_tracker.hpp"

namespace lab::tracker {

/// Searches the whole of every picture. The detections of all cameras are joined before they
/// are tracked, so there is one tracker, and a robot keeps its identity across seams. Receivers
/// see the messages of a single camera: its number of pictures is the number of rounds, and a
/// track's place in the picture is that in the picture of the best camera.
///
/// A camera that is lost costs only its part of the arena. Its loss and its return are errors of
/// the service's heartbeat, and the tracker's warning names it for as long as it is lost.
class SeveralCamerasService final : public Service {
 public:
  /// @throws ExperimentError if a calibration cannot be read or is for another picture size.
  /// @throws CameraError if a camera cannot be used.
  explicit SeveralCamerasService(const ServiceContext& context);
  ~SeveralCamerasService() override;

 private:
  struct Input;

  void open(std::size_t i, Cameras& cameras);
  void handle(const robot_status_t& status);
  void handle(std::size_t i, const CameraFrame& frame);
  void findResponse(Input& input, const optics::GreyView& picture);
  void trouble(std::size_t i, const std::string& what);
  void ended(std::size_t i, const std::string& problem);
  void lose(std::size_t i, const std::string& why);
  void noteSilent();
  void publish(const FusedRound& round);
  void watchLight();
  void readSync(const Input& input, const CameraFrame& frame);
  void film(std::size_t i, const CameraFrame& frame, std::int64_t arrived,
            std::uint64_t lost_cameras);
  [[nodiscard]] std::uint64_t lostCameras() const;
  void report();
  [[nodiscard]] std::string lostText() const;
  [[nodiscard]] double seconds(std::int64_t utime) const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  detector::MarkerSettings markers_;
  std::vector<std::unique_ptr<Input>> inputs_;
  CameraFusion fusion_;
  std::unique_ptr<MarkerTracker> tracker_;
  Latency latency_;
  std::optional<SyncReader> sync_;          ///< if a camera sees the projector's sync patch
  const Input* sync_input_ = nullptr;       ///< that camera
  std::optional<cameras::RunFilmer> film_;  ///< of the run, if it is wanted
  std::int64_t status_instance_ = 0;        ///< of the last ROBOT_STATUS
  std::int64_t status_seq_ = 0;
  std::int8_t origin_;         ///< as in robot_state_t
  std::int64_t origin_utime_;  ///< utime of the tracker's time 0
  tracker_status_t status_{};
  std::vector<WheelReport> wheels_;
};

}  // namespace lab::tracker
