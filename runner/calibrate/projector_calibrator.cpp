#include "runner/calibrate/projector_calibrator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/math/units.hpp"
#include "tracker_svc/camera_devices.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kPatternTick_us = 10'000;
constexpr std::int64_t kPatternRepeat_us = 500'000;
constexpr std::int64_t kPatternTimeout_us = 10'000'000;

}  // namespace

ProjectorCalibrator::ProjectorCalibrator(
    const ServiceContext& context, ExperimentController& controller,
    std::vector<calibration::LightPattern> patterns, std::int64_t frames,
    std::function<void(std::size_t, const optics::GreyView&)> take,
    std::function<void(const std::string&)> done)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      controller_(controller),
      patterns_(std::move(patterns)),
      frames_(frames),
      take_(std::move(take)),
      done_(std::move(done)) {
  node_.subscribe<light_status_t>(channels::kLightStatus,
                                  [this](const light_status_t& status) { hear(status); });
  const auto trouble = [this](const std::string& what) { trouble_ = what; };
  source_ = context.cameras.open(experiment_.camera.source, wantedFormat(experiment_.camera),
                                 {.frame = [this](const CameraFrame& frame) { see(frame); },
                                  .trouble = trouble,
                                  .end = trouble});
  loop_.every(kPatternTick_us, loop_.now() + kPatternTick_us, [this] { tick(); });
}

void ProjectorCalibrator::tick() {
  const std::int64_t now = loop_.now();
  if (over_) return;
  if (!running_) {
    if (!controller_.inScript()) return;
    running_ = true;
    show();
  }
  if (now >= next_send_utime_) send();
  if (now - progress_utime_ > kPatternTimeout_us) end(timeoutText());
}

std::string ProjectorCalibrator::timeoutText() const {
  const std::string what = fmt::format("pattern {} of {}", pattern_ + 1, patterns_.size());
  if (shown_from_ == 0) {
    return what +
           ": LIGHT_STATUS did not report within 10 s that it is shown; does projector_ctl run, "
           "and does another program command the light?";
  }
  return fmt::format("{}: no picture of it arrived from the camera \"{}\" within 10 s{}{}", what,
                     experiment_.camera.source, trouble_.empty() ? "" : ": ", trouble_);
}

void ProjectorCalibrator::show() {
  command_.priority = light_command_t::MANUAL;
  command_.label = fmt::format("calibration {} of {}", pattern_ + 1, patterns_.size());
  setLayers(command_, {{patterns_[pattern_].layer, {}}});
  ++command_.seq;
  shown_from_ = 0;
  taken_ = 0;
  progress_utime_ = loop_.now();
  send();
}

void ProjectorCalibrator::send() {
  next_send_utime_ = loop_.now() + kPatternRepeat_us;
  command_.utime = 0;
  node_.publishCommand(channels::kLightCommand, command_);
}

void ProjectorCalibrator::hear(const light_status_t& status) {
  const NodeIdentity& own = node_.identity();
  const bool own_pattern = running_ && status.commander == own.name &&
                           status.command_instance == own.instance &&
                           status.command_seq == command_.seq;
  if (!own_pattern || status.moving != 0) {
    shown_from_ = 0;
    return;
  }
  if (shown_from_ != 0) return;
  shown_from_ = std::max(status.utime, status.first_shown_utime) +
                units::microseconds(status.frame_period + experiment_.camera.exposure / 2);
  progress_utime_ = loop_.now();
}

void ProjectorCalibrator::see(const CameraFrame& frame) {
  trouble_.clear();
  if (!running_ || over_ || shown_from_ == 0 || frame.utime < shown_from_) return;
  if (frame.grey.width != experiment_.camera.width ||
      frame.grey.height != experiment_.camera.height) {
    end(fmt::format(
        "the camera gives pictures of {} x {} pixels, expected {} x {} as in the "
        "experiment",
        frame.grey.width, frame.grey.height, experiment_.camera.width, experiment_.camera.height));
    return;
  }
  take_(pattern_, frame.grey);
  progress_utime_ = loop_.now();
  if (++taken_ < frames_) return;
  if (++pattern_ == patterns_.size()) {
    end("");
  } else {
    show();
  }
}

void ProjectorCalibrator::end(const std::string& problem) {
  over_ = true;
  command_.release = 1;
  setLayers(command_, {});
  ++command_.seq;
  send();
  done_(problem);
}

}  // namespace lab::runner
