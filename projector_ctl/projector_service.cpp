#include "projector_ctl/projector_service.hpp"

#include <algorithm>
#include <cmath>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_state_t.hpp>
#include <utility>

#include "common/channels.hpp"
#include "common/units.hpp"
#include "light/raster.hpp"

namespace lab::projector {

namespace {

LightCommand toCommand(const light_command_t& message, const light::ImageStore& images) {
  LightCommand command;
  command.sender = message.sender;
  command.instance = message.instance;
  command.seq = message.seq;
  command.priority = message.priority;
  command.from_utime = message.from_utime;
  command.ramp = message.ramp;
  command.hold_until_utime = message.hold_until_utime;
  command.release = message.release != 0;
  command.label = message.label;
  command.layers = toLayers(message.layers, images);
  return command;
}

ProjectorCore::Config coreConfig(const Experiment& experiment) {
  ProjectorCore::Config config;
  config.safe_field = {light::Layer{.intensity = experiment.light.safe_intensity}};
  return config;
}

}  // namespace

ProjectorService::ProjectorService(const ServiceContext& context, std::filesystem::path pictures)
    : node_(context.node),
      loop_(context.loop),
      pictures_(std::move(pictures)),
      arena_width_(context.experiment.arena_width),
      arena_height_(context.experiment.arena_height),
      images_(loadImages(context.experiment, context.directory).store),
      clock_(context.experiment.light.frame_rate),
      core_(coreConfig(context.experiment)) {
  node_.subscribe<light_command_t>(channels::kLightCommand, [this](const light_command_t& message) {
    arrivals_.push_back({toCommand(message, images_), loop_.now()});
  });
  scheduleFrame(clock_.numberAtOrAfter(loop_.now()));
}

void ProjectorService::scheduleFrame(std::int64_t number) {
  loop_.at(clock_.boundary(number), [this, number] {
    showFrame(clock_.boundary(number));
    // A loop that fell behind leaves frames out, as a display would.
    scheduleFrame(std::max(number + 1, clock_.numberAtOrAfter(loop_.now())));
  });
}

void ProjectorService::applyUntil(std::int64_t utime) {
  std::size_t applied = 0;
  // What arrived while a late timer was on its way belongs to the next frame.
  while (applied < arrivals_.size() && arrivals_[applied].utime <= utime) {
    const LightCommand& command = arrivals_[applied].command;
    const Answer answer = core_.apply(command, arrivals_[applied].utime);
    if (answer.verdict == Verdict::kRefused) {
      const std::string refusal = "LIGHT_COMMAND " + std::to_string(command.seq) + " of " +
                                  command.sender + ": " + answer.reason;
      if (refusal != last_refusal_) {
        node_.noteError(refusal);
        last_refusal_ = refusal;
        refused_ = true;
      }
    }
    ++applied;
  }
  arrivals_.erase(arrivals_.begin(), arrivals_.begin() + static_cast<std::ptrdiff_t>(applied));
}

void ProjectorService::showFrame(std::int64_t presentation_utime) {
  applyUntil(presentation_utime);
  const Shown& shown = core_.frame(presentation_utime);
  const double silent = units::seconds(presentation_utime - status_utime_);
  const bool due = silent > 1 / kStatusRate - 0.5 * clock_.period();
  if (shown.changed || shown.moving || refused_ || due) {
    publish(shown);
    status_utime_ = presentation_utime;
    refused_ = false;
  }
  if (shown.frame == 1) node_.ready();
  if (!pictures_.empty() && !shown.moving && shown.first_shown_utime != pictured_utime_) {
    savePicture(shown);
    pictured_utime_ = shown.first_shown_utime;
  }
}

void ProjectorService::publish(const Shown& shown) {
  light_status_t status{};
  status.utime = shown.presentation_utime;
  status.frame = shown.frame;
  status.frame_period = clock_.period();
  status.commander = shown.commander;
  status.command_instance = shown.instance;
  status.command_seq = shown.seq;
  status.label = shown.label;
  status.first_shown_utime = shown.first_shown_utime;
  status.moving = shown.moving ? 1 : 0;
  status.last_refusal = last_refusal_;
  status.mix = shown.field.mix;
  status.previous = toMessages(shown.field.previous);
  status.num_previous = static_cast<std::int32_t>(status.previous.size());
  status.layers = toMessages(shown.field.layers);
  status.num_layers = static_cast<std::int32_t>(status.layers.size());
  node_.publish(channels::kLightStatus, status);
}

void ProjectorService::savePicture(const Shown& shown) {
  const int rows =
      std::max(1, static_cast<int>(std::lround(kPictureColumns * arena_height_ / arena_width_)));
  const light::Raster raster =
      light::rasterise(shown.field, arena_width_, arena_height_, kPictureColumns, rows);
  const std::string name = "light_" + std::to_string(shown.first_shown_utime) + ".png";
  if (const auto error = light::writeFile(pictures_ / name, light::toPng(raster))) {
    node_.noteError(*error);
  }
}

ServiceDescription serviceDescription() {
  ServiceDescription description;
  description.name = "projector_ctl";
  description.summary = "The light field: what the arena shows, where, since when";
  description.origin = robot_state_t::SIM;
  description.make = [](const ServiceContext& context) {
    return std::make_unique<ProjectorService>(context);
  };
  return description;
}

}  // namespace lab::projector
