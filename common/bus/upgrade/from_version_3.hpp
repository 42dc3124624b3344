/// Converts the messages that contract version 4 changed.
#pragma once

#include <lab/experiment_event_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab_v3/experiment_event_t.hpp>
#include <lab_v3/light_command_t.hpp>
#include <lab_v3/light_status_t.hpp>

namespace lab {

[[nodiscard]] light_command_t convert(const lab_v3::light_command_t& old);
[[nodiscard]] light_status_t convert(const lab_v3::light_status_t& old);
[[nodiscard]] experiment_event_t convert(const lab_v3::experiment_event_t& old);

}  // namespace lab
