/// Shows light patterns in a running lab and collects camera pictures of them.
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

/// Commands one pattern after the other by LIGHT_COMMAND, waits until LIGHT_STATUS reports that it
/// is shown, and collects frames whose exposure began at least one projector frame later, because
/// the projector has a delay of its own.
class ProjectorCalibrator final : public Service {
 public:
  /// @param frames camera frames per pattern
  /// @param take called with the index of the pattern and each frame
  /// @param done called at the end, with the error; empty on success
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
  [[nodiscard]] std::string timeoutText() const;

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
  std::int64_t taken_ = 0;       ///< frames of the current pattern
  std::int64_t shown_from_ = 0;  ///< utime since which the pattern is shown; 0 if not yet
  std::int64_t progress_utime_ = 0;
  std::int64_t next_send_utime_ = 0;
  std::string trouble_;  ///< latest error of the camera
  light_command_t command_{};
  std::unique_ptr<FrameSource> source_;
};

}  // namespace lab::runner
