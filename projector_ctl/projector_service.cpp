#include "projector_ctl/projector_service.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <stdexcept>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/calibration/light_file.hpp"
#include "common/calibration/projector_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/files/atomic_file.hpp"
#include "common/math/units.hpp"
#include "light/field/raster.hpp"
#include "projector_ctl/projector_messages.hpp"

namespace lab::projector {

namespace {

constexpr std::int64_t kAhead_us = 1'000'000;

ProjectorCore::Config coreConfig(const Experiment& experiment, const light::ImageStore& images) {
  ProjectorCore::Config config;
  config.safe_field = {light::Layer{.intensity = experiment.light.safe_intensity}};
  config.scene_context = sceneContextOf(experiment, images);
  config.latency = experiment.projector.latency;
  if (experiment.camera.tracker == Tracker::kCamera) {
    config.sync_patch = experiment.projector.sync_patch;
  }
  return config;
}

/// The overlay on the projected picture: frame rate, vsync, command, calibration and error.
/// @param rate measured [Hz]
std::vector<std::string> overlayLines(const ShownFrame& shown,
                                      const FrameLoop::SwappedFrame& swapped, double rate) {
  constexpr std::size_t kLongest = 60;  // characters
  char frames[32];
  std::snprintf(frames, sizeof frames, "%.1f fps", rate);
  std::vector<std::string> lines = {
      frames + (", vsync " + swapped.vsync),
      shown.commander.empty() ? shown.label.substr(0, kLongest)
                              : shown.commander + " " + std::to_string(shown.seq) + " " +
                                    shown.label.substr(0, kLongest),
      "calibration " + (swapped.calibration_id.empty() ? "none" : swapped.calibration_id)};
  if (!swapped.trouble.empty()) lines.push_back(swapped.trouble.substr(0, kLongest));
  return lines;
}

}  // namespace

ProjectorService::ProjectorService(const ServiceContext& context, std::filesystem::path pictures,
                                   std::unique_ptr<Presenter> presenter)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      pictures_(std::move(pictures)),
      arena_width_(context.experiment.arena_width),
      arena_height_(context.experiment.arena_height),
      images_(loadImages(context.experiment, context.directory).store),
      clock_(context.experiment.light.frame_rate),
      core_(coreConfig(context.experiment, images_)) {
  const Projector& projector = experiment_.projector;
  if (presenter == nullptr) {
    // A display that is not opened, as in virtual time, is assumed to have the size in its
    // calibration.
    const std::string& file = projector.calibration;
    const bool simulated = projector.display == kHeadless || file.empty();
    const std::string placed = simulated
                                   ? activeProjectorCalibration(experiment_, context.directory,
                                                                projector.width, projector.height)
                                         .id
                                   : readProjectorFile(context.directory / file).id;
    const auto light = activeLightCalibration(experiment_, context.directory);
    headless_calibration_ = joinCalibrationIds(placed, light ? light->id : "");
  }
  node_.subscribe<light_command_t>(channels::kLightCommand, [this](const light_command_t& message) {
    arrivals_.push_back({toCommand(message, experiment_, images_), loop_.now()});
  });
  node_.subscribe<tracked_frame_t>(channels::kTrackedFrame, [this](const tracked_frame_t& message) {
    // If a tracker's clock runs ahead, all later correct times would be taken for old ones.
    if (message.utime > loop_.now() + kAhead_us) {
      if (!std::exchange(future_frame_reported_, true)) {
        node_.noteError(
            "TRACKED_FRAME " + std::to_string(message.frame) + " of " + message.sender +
            " is dated more than a second ahead: not used for the light; set the clocks");
      }
      return;
    }
    frames_.push_back({toObservedFrame(message), loop_.now()});
  });
  node_.subscribe<robot_status_t>(
      channels::kRobotStatus, [this](const robot_status_t& message) { reportPrograms(message); });
  loop_of_frames_ = std::make_unique<FrameLoop>(
      loop_, clock_,
      FrameLoop::Callbacks{
          [this](std::int64_t swap) -> const light::Field& { return decide(swap); },
          [this](const FrameLoop::SwappedFrame& swapped) { frameShown(swapped); },
          [this] { return overlayLines(*shown_, swapped_, loop_of_frames_->rate()); }},
      std::move(presenter));
}

void ProjectorService::applyUntil(std::int64_t utime) {
  std::size_t applied = 0;
  // If the timer is late, commands that arrived after the frame's time belong to the next frame.
  while (applied < arrivals_.size() && arrivals_[applied].utime <= utime) {
    const LightCommand& command = arrivals_[applied].command;
    const Answer answer = core_.apply(command, arrivals_[applied].utime);
    if (answer.verdict == Verdict::kRefused) {
      const std::string refusal = formatRefusal(command.sender, command.seq, answer.reason);
      if (refusal != last_refusal_) {
        node_.noteError(refusal);
        last_refusal_ = refusal;
        publish_ = true;
      }
    }
    ++applied;
  }
  arrivals_.erase(arrivals_.begin(), arrivals_.begin() + static_cast<std::ptrdiff_t>(applied));
  passFrames(utime);
}

/// A LIGHT_STATUS names the frames of one tracker only. Frames of another tracker wait for the next
/// picture.
void ProjectorService::passFrames(std::int64_t utime) {
  if (frames_.empty()) return;
  const std::int64_t instance =
      entered_.empty() ? frames_.front().frame.instance : entered_tracker_;
  std::erase_if(frames_, [&](FrameArrival& arrival) {
    const bool takes = arrival.utime <= utime && arrival.frame.instance == instance;
    if (takes) core_.addFrame(std::move(arrival.frame));
    return takes;
  });
  publish_ = publish_ || std::ranges::any_of(frames_, [&](const FrameArrival& arrival) {
               return arrival.frame.instance != instance;
             });
}

void ProjectorService::reportPrograms(const robot_status_t& status) {
  for (const robot_state_t& robot : status.robots) {
    core_.report(robot.robot_id, programName(experiment_, robot.program), robot.utime);
  }
}

const light::Field& ProjectorService::decide(std::int64_t swap_utime) {
  applyUntil(swap_utime);
  shown_ = &core_.frame(swap_utime);
  return shown_->field;
}

void ProjectorService::frameShown(const FrameLoop::SwappedFrame& swapped) {
  const ShownFrame& shown = *shown_;
  const bool other_display = swapped.display != swapped_.display ||
                             swapped.vsync != swapped_.vsync || swapped.trouble != swapped_.trouble;
  publish_ = publish_ || other_display;
  if (swapped.trouble != swapped_.trouble && !swapped.trouble.empty()) {
    node_.noteError(swapped.trouble);
  }
  swapped_ = swapped;
  if (shown.first_shown_utime == shown.presentation_utime) first_light_utime_ = lightUtime();
  noteEntered(shown);
  if (shown.trouble != trouble_) {
    trouble_ = shown.trouble;
    if (!trouble_.empty()) node_.noteError(trouble_);
  }
  const double silent = units::seconds(swapped.utime - status_utime_);
  const bool due = silent > 1 / kStatusRate - 0.5 * swapped.period;
  if (shown.changed || publish_ || due) {
    publish(shown);
    status_utime_ = swapped.utime;
    publish_ = false;
  }
  if (shown.frame == 1) node_.ready();
  if (!pictures_.empty() && !light::isMoving(shown.field) &&
      shown.first_shown_utime != pictured_utime_) {
    savePicture(shown);
    pictured_utime_ = shown.first_shown_utime;
  }
}

void ProjectorService::noteEntered(const ShownFrame& shown) {
  if (shown.tracker_instance != entered_tracker_) entered_.clear();
  entered_tracker_ = shown.tracker_instance;
  entered_.insert(entered_.end(), shown.tracked_frames.begin(), shown.tracked_frames.end());
}

std::int64_t ProjectorService::lightUtime() const {
  return swapped_.utime + std::llround(1e6 * experiment_.projector.latency);
}

void ProjectorService::publish(const ShownFrame& shown) {
  light_status_t status{};
  status.utime = lightUtime();
  status.frame = shown.frame;
  status.frame_period = swapped_.period;
  status.commander = shown.commander;
  status.command_instance = shown.instance;
  status.command_seq = shown.seq;
  status.label = shown.label;
  status.first_shown_utime = first_light_utime_;
  status.calibration_id =
      headless_calibration_.empty() ? swapped_.calibration_id : headless_calibration_;
  status.moving = shown.moving ? 1 : 0;
  status.last_refusal = last_refusal_;
  status.display = swapped_.display;
  status.vsync = swapped_.vsync;
  status.latency = experiment_.projector.latency;
  status.sync = static_cast<std::int8_t>(shown.sync);
  status.trouble = shown.trouble;
  if (!swapped_.trouble.empty()) {
    status.trouble = swapped_.trouble + (shown.trouble.empty() ? "" : "; " + shown.trouble);
  }
  status.tracker_instance = entered_tracker_;
  status.tracked_frames = entered_;
  status.num_tracked_frames = static_cast<std::int32_t>(entered_.size());
  entered_.clear();
  status.mix = shown.field.mix;
  status.previous = toMessages(shown.field.previous);
  status.num_previous = static_cast<std::int32_t>(status.previous.size());
  status.layers = toMessages(shown.field.layers);
  status.num_layers = static_cast<std::int32_t>(status.layers.size());
  node_.publish(channels::kLightStatus, status);
}

void ProjectorService::savePicture(const ShownFrame& shown) {
  const light::PictureSize size = light::pictureSize(arena_width_, arena_height_, kPictureColumns);
  const light::Raster raster =
      light::rasterise(shown.field, arena_width_, arena_height_, size.nx, size.ny);
  const std::string name = "light_" + std::to_string(shown.first_shown_utime) + ".png";
  try {
    replaceFile(pictures_ / name, light::toPng(raster));
  } catch (const std::runtime_error& error) {
    node_.noteError(error.what());
  }
}

ServiceDescription serviceDescription() {
  ServiceDescription description;
  description.name = "projector_ctl";
  description.summary = "Light-field server: shows light on the arena and reports what is shown";
  description.origin = robot_state_t::SIM;
  description.make = [](const ServiceContext& context) {
    return std::make_unique<ProjectorService>(context);
  };
  return description;
}

}  // namespace lab::projector
