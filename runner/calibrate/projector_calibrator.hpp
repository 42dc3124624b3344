/// Shows structured light in a running lab and takes the camera's pictures of it.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <memory>
#include <string>
#include <vector>

#include "projector_ctl/calibration/projector_patterns.hpp"
#include "runner/live/procedure.hpp"

namespace lab::runner {

/// Commands one pattern after the other as anybody may, waits until LIGHT_STATUS says that it is on
/// the arena, and takes so many frames that were exposed wholly after that, less one frame of the
/// projector for its own delay.
class ProjectorCalibrator final : public Service {
 public:
  /// @param frames of the camera for each pattern
  /// @param take called with each of them and the number of its pattern
  /// @param done called at the end, with what went wrong; empty: nothing
  ProjectorCalibrator(const ServiceContext& context, ExperimentController& controller,
                      std::vector<calibration::LightPattern> patterns, std::int64_t frames,
                      std::function<void(std::size_t, const optics::GreyView&)> take,
                      std::function<void(const std::string&)> done);

 private:
  void tick();
  void show();
  void send();
  void hear(const light_status_t& status);
  void see(const CameraFrame& frame);
  void end(const std::string& problem);
  [[nodiscard]] std::string waitedFor() const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  ExperimentController& controller_;
  std::vector<calibration::LightPattern> patterns_;
  std::int64_t frames_;
  std::function<void(std::size_t, const optics::GreyView&)> take_;
  std::function<void(const std::string&)> done_;

  bool running_ = false;
  bool over_ = false;
  std::size_t pattern_ = 0;
  std::int64_t taken_ = 0;  ///< frames of this pattern
  std::int64_t shown_from_ =
      0;  ///< utime from which the pattern is surely on the arena, 0: not yet
  std::int64_t progress_utime_ = 0;
  std::int64_t next_send_utime_ = 0;
  std::string trouble_;  ///< of the camera
  light_command_t command_{};
  std::unique_ptr<FrameSource> source_;
};

}  // namespace lab::runner
