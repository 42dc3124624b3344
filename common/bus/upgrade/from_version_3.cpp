#include "common/bus/upgrade/from_version_3.hpp"

#include <cstdint>
#include <vector>

#include "common/bus/upgrade/copied_header.hpp"

namespace lab {
namespace {

light_layer_t convert(const lab_v3::light_layer_t& old) {
  light_layer_t layer{};
  layer.kind = old.kind;
  layer.blend = old.blend;
  layer.x = old.x;
  layer.y = old.y;
  layer.angle = old.angle;
  layer.size = old.size;
  layer.inner = old.inner;
  layer.softness = old.softness;
  layer.intensity = old.intensity;
  layer.intensity2 = old.intensity2;
  layer.image = old.image;
  return layer;
}

std::vector<light_layer_t> convert(const std::vector<lab_v3::light_layer_t>& old) {
  std::vector<light_layer_t> layers;
  for (const lab_v3::light_layer_t& layer : old) layers.push_back(convert(layer));
  return layers;
}

}  // namespace

light_command_t convert(const lab_v3::light_command_t& old) {
  auto command = withHeaderOf<light_command_t>(old);
  command.priority = old.priority;
  command.from_utime = old.from_utime;
  command.ramp = old.ramp;
  command.hold_until_utime = old.hold_until_utime;
  command.release = old.release;
  command.label = old.label;
  command.layers = convert(old.layers);
  command.num_layers = static_cast<std::int32_t>(command.layers.size());
  return command;
}

light_status_t convert(const lab_v3::light_status_t& old) {
  auto status = withHeaderOf<light_status_t>(old);
  status.frame = old.frame;
  status.frame_period = old.frame_period;
  status.commander = old.commander;
  status.command_instance = old.command_instance;
  status.command_seq = old.command_seq;
  status.label = old.label;
  status.first_shown_utime = old.first_shown_utime;
  status.moving = old.moving;
  status.calibration_id = old.calibration_id;
  status.last_refusal = old.last_refusal;
  // Up to version 3 the projector was always headless.
  status.display = "headless";
  status.vsync = "clock";
  status.sync = -1;
  status.mix = old.mix;
  status.previous = convert(old.previous);
  status.num_previous = static_cast<std::int32_t>(status.previous.size());
  status.layers = convert(old.layers);
  status.num_layers = static_cast<std::int32_t>(status.layers.size());
  return status;
}

experiment_event_t convert(const lab_v3::experiment_event_t& old) {
  auto event = withHeaderOf<experiment_event_t>(old);
  event.kind = old.kind;
  event.text = old.text;
  event.contract_version = old.contract_version;
  event.fingerprints = old.fingerprints;
  event.version = old.version;
  event.step = old.step;
  event.label = old.label;
  event.commanded_utime = old.commanded_utime;
  event.presented_utime = old.presented_utime;
  event.first_acted_utime = old.first_acted_utime;
  event.last_acted_utime = old.last_acted_utime;
  event.robots_acted = old.robots_acted;
  event.robots_expected = old.robots_expected;
  return event;
}

}  // namespace lab
