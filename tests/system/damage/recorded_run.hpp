/// A short run in virtual time: messages of every service, as a basis for damaged ones.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/experiment_file.hpp"
#include "runner/virtual_time/run_virtual.hpp"
#include "tests/support/mutated_log.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::damage {

/// Robots on the bus and on the wire, two programs, light that moves.
inline constexpr std::string_view kExperiment = R"(fileversion = 1
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

inline Experiment experiment() { return parseExperiment(std::string(kExperiment), "damage.toml"); }

/// The messages of this experiment, made once per process.
inline const std::vector<RecordedMessage>& recordedRun() {
  static const std::vector<RecordedMessage> messages = [] {
    const TemporaryFolder folder;
    const runner::PreparedRun run =
        runner::prepareRun(experiment(), folder.path() / "damage.toml", folder.path() / "runs", 1);
    const auto outcome = runner::runVirtual(
        run, [](const runner::Progress&) {}, [] { return false; });
    static_cast<void>(outcome);
    return recordedMessages(run.directory / "log.lcmlog");
  }();
  return messages;
}

}  // namespace lab::damage
