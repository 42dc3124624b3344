/// The projector on the bus: LIGHT_COMMAND in, LIGHT_STATUS out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/light_messages.hpp"
#include "common/service_main.hpp"
#include "projector_ctl/frame_clock.hpp"
#include "projector_ctl/projector_core.hpp"

namespace lab::projector {

/// Headless: it shows its field to whoever listens to LIGHT_STATUS, frame by frame at the
/// experiment's frame rate. LIGHT_STATUS goes out with every frame that differs from the last or
/// that will differ from the next, and at 10 Hz otherwise. A refused command is said in
/// last_refusal and in the heartbeat; what was shown stays.
class ProjectorService final : public Service {
 public:
  static constexpr double kStatusRate = 10;  ///< [Hz] while nothing changes
  static constexpr int kPictureColumns = 480;

  /// Subscribes, and shows its first frame at the first frame boundary from now on.
  /// @param pictures where each new field is left as light_<first shown utime>.png once it is fully
  /// faded in, the arena in kPictureColumns columns; empty: nowhere.
  /// @throws std::runtime_error when an image of the experiment cannot be read.
  explicit ProjectorService(const ServiceContext& context, std::filesystem::path pictures = {});

 private:
  struct Arrival {
    LightCommand command;
    std::int64_t utime;
  };

  void scheduleFrame(std::int64_t number);
  void showFrame(std::int64_t presentation_utime);
  void applyUntil(std::int64_t utime);
  void publish(const Shown& shown);
  void savePicture(const Shown& shown);

  Node& node_;
  Loop& loop_;
  std::filesystem::path pictures_;
  double arena_width_;   ///< [m]
  double arena_height_;  ///< [m]
  light::ImageStore images_;
  FrameClock clock_;
  ProjectorCore core_;
  std::vector<Arrival> arrivals_;  ///< not yet given to the core
  std::string last_refusal_;
  bool refused_ = false;             ///< since the last LIGHT_STATUS
  std::int64_t pictured_utime_ = 0;  ///< first_shown_utime of what the last picture shows
  std::int64_t status_utime_ = 0;    ///< of the last LIGHT_STATUS
};

/// The service as a process or as a part of a lab in one process.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::projector
