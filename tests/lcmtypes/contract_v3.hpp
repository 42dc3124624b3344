/// The types of contract version 3 that logs still hold, as contract.hpp has those of today.
#pragma once

#include <lab_v3/experiment_event_t.hpp>
#include <lab_v3/light_command_t.hpp>
#include <lab_v3/light_layer_t.hpp>
#include <lab_v3/light_status_t.hpp>
#include <tuple>

#include "tests/lcmtypes/contract.hpp"

namespace lab_v3 {

using AllTypes = lab::TypeList<experiment_event_t, light_command_t, light_layer_t, light_status_t>;

inline auto fields(light_layer_t& m) {
  return std::tie(m.kind, m.blend, m.x, m.y, m.angle, m.size, m.inner, m.softness, m.intensity,
                  m.intensity2, m.image);
}
inline auto fields(experiment_event_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.kind, m.text, m.contract_version,
                  m.fingerprints, m.version, m.step, m.label, m.commanded_utime, m.presented_utime,
                  m.first_acted_utime, m.last_acted_utime, m.robots_acted, m.robots_expected);
}
inline auto fields(light_command_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.priority, m.from_utime, m.ramp,
                  m.hold_until_utime, m.release, m.label, m.num_layers, m.layers);
}
inline auto fields(light_status_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.frame, m.frame_period, m.commander,
                  m.command_instance, m.command_seq, m.label, m.first_shown_utime, m.moving,
                  m.calibration_id, m.last_refusal, m.mix, m.num_previous, m.previous, m.num_layers,
                  m.layers);
}

}  // namespace lab_v3
