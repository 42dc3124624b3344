/// Connects the projector with the bus: receives LIGHT_COMMAND, TRACKED_FRAME and ROBOT_STATUS,
/// sends LIGHT_STATUS.
#pragma once

#include <cstdint>
#include <filesystem>
#include <lab/robot_status_t.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/experiment/light_messages.hpp"
#include "common/service/service_main.hpp"
#include "projector_ctl/display/frame_clock.hpp"
#include "projector_ctl/display/frame_loop.hpp"
#include "projector_ctl/projector_core.hpp"

namespace lab::projector {

/// Shows the light field on a display, frame by frame at the display's refreshes. Headless, it only
/// publishes LIGHT_STATUS, with the experiment's frame rate. LIGHT_STATUS is sent with every frame
/// that differs from the previous one, and at 10 Hz otherwise. The refusal of a command is reported
/// in last_refusal and in the heartbeat, and the light does not change.
class ProjectorService final : public Service {
 public:
  static constexpr double kStatusRate = 10;  ///< [Hz] while nothing changes
  static constexpr int kPictureColumns = 480;

  /// Subscribes, and shows its first frame at the next frame boundary.
  /// @param pictures folder in which each new field is saved as light_<first shown utime>.png at
  ///   the end of its cross-fade, with at most kPictureColumns columns; empty: not saved
  /// @param presenter the display; null: headless
  /// @throws std::runtime_error if an image of the experiment cannot be read
  explicit ProjectorService(const ServiceContext& context, std::filesystem::path pictures = {},
                            std::unique_ptr<Presenter> presenter = nullptr);

 private:
  struct Arrival {
    LightCommand command;
    std::int64_t utime;
  };

  struct FrameArrival {
    ObservedFrame frame;
    std::int64_t utime;
  };

  const light::Field& decide(std::int64_t swap_utime);
  void frameShown(const FrameLoop::SwappedFrame& swapped);
  void applyUntil(std::int64_t utime);
  void passFrames(std::int64_t utime);
  void reportPrograms(const robot_status_t& status);
  void noteEntered(const ShownFrame& shown);
  void publish(const ShownFrame& shown);
  void savePicture(const ShownFrame& shown);
  [[nodiscard]] std::int64_t lightUtime() const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  std::filesystem::path pictures_;
  double arena_width_;   ///< [m]
  double arena_height_;  ///< [m]
  light::ImageStore images_;
  FrameClock clock_;
  ProjectorCore core_;
  std::vector<Arrival> arrivals_;      ///< not yet passed to the core
  std::vector<FrameArrival> frames_;   ///< not yet passed to the core
  std::vector<std::int64_t> entered_;  ///< numbers of frames in use since the last LIGHT_STATUS
  std::int64_t entered_tracker_ = 0;
  std::string headless_calibration_;  ///< id of the calibration without a display; empty: none
  bool future_frame_reported_ = false;
  std::string last_refusal_;
  std::string trouble_;
  bool publish_ = false;                ///< publish the next frame even if it does not change
  std::int64_t pictured_utime_ = 0;     ///< first_shown_utime of the field in the last picture
  std::int64_t status_utime_ = 0;       ///< time of the last LIGHT_STATUS
  const ShownFrame* shown_ = nullptr;   ///< the frame in progress
  FrameLoop::SwappedFrame swapped_;     ///< the last frame shown
  std::int64_t first_light_utime_ = 0;  ///< when the present command was first on the arena
  std::unique_ptr<FrameLoop> loop_of_frames_;
};

/// The service, for a process of its own or as part of a lab in one process.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::projector
