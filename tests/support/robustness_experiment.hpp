/// The experiment of the tests that feed damaged or invented messages to the services.
#pragma once

#include <string_view>

namespace lab {

/// Robots on the bus and on the wire, two programs, light that moves.
inline constexpr std::string_view kRobustnessExperiment = R"(fileversion = 1
name = "damage"
duration_s = 6
seed = 3
robots = [
  {id = 1, x_cm = 24, y_cm = 24, theta_deg = 0},
  {id = 2, x_cm = 60, y_cm = 24, theta_deg = 120},
  {id = 7, x_cm = 96, y_cm = 24, theta_deg = 240, body = "wire"},
]
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
[programs.rtp]
model = "rtp"
v_cm_s = 5
gamma_per_s = 3
tau_t_s = 0.5
[light_table]
bands = [{light = [0.0, 0.5], program = "abp"}, {light = [0.5, 1.0], program = "rtp"}]
[reversal]
on = "any"
[[light.steps]]
hold_s = 3
layers = [{kind = "uniform", intensity = 0.2}]
[[light.steps]]
hold_s = 3
layers = [{kind = "disk", x_cm = 60, y_cm = 45, radius_cm = 30, intensity = 0.8}]
)";

}  // namespace lab
