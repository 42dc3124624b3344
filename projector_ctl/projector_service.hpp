/// The projector on the bus: LIGHT_COMMAND, TRACKED_FRAME and ROBOT_STATUS in, LIGHT_STATUS out.
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

/// Frame by frame it shows its field on a display, at the display's refreshes, or headless, to
/// whoever listens to LIGHT_STATUS, at the experiment's frame rate. LIGHT_STATUS goes out with
/// every frame that differs from the last, and at 10 Hz otherwise. A refused command is said in
/// last_refusal and in the heartbeat; what was shown stays.
class ProjectorService final : public Service {
 public:
  static constexpr double kStatusRate = 10;  ///< [Hz] while nothing changes
  static constexpr int kPictureColumns = 480;

  /// Subscribes, and shows its first frame at the first frame boundary from now on.
  /// @param pictures where each new field is left as light_<first shown utime>.png once it is fully
  /// faded in, the arena in kPictureColumns columns; empty: nowhere.
  /// @throws std::runtime_error when an image of the experiment cannot be read.
  /// @param presenter the display, null: headless
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
  void takeFrames(std::int64_t utime);
  void takePrograms(const robot_status_t& status);
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
  std::vector<Arrival> arrivals_;      ///< not yet given to the core
  std::vector<FrameArrival> frames_;   ///< not yet given to the core
  std::vector<std::int64_t> entered_;  ///< numbers of frames in use since the last LIGHT_STATUS
  std::int64_t entered_tracker_ = 0;
  std::string headless_calibration_;  ///< id of that in force without a display, empty: none
  bool told_of_future_ = false;
  std::string last_refusal_;
  std::string trouble_;
  bool publish_ = false;                ///< with the next frame, whether it changes or not
  std::int64_t pictured_utime_ = 0;     ///< first_shown_utime of what the last picture shows
  std::int64_t status_utime_ = 0;       ///< of the last LIGHT_STATUS
  const ShownFrame* shown_ = nullptr;   ///< of the frame under way
  FrameLoop::SwappedFrame swapped_;     ///< the frame shown last
  std::int64_t first_light_utime_ = 0;  ///< of the command shown
  std::unique_ptr<FrameLoop> loop_of_frames_;
};

/// The service as a process or as a part of a lab in one process.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::projector
