/// A short run in virtual time: messages of every service, as a basis for damaged ones.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/experiment/experiment_file.hpp"
#include "runner/virtual_time/run_virtual.hpp"
#include "tests/support/mutated_log.hpp"
#include "tests/support/robustness_experiment.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::damage {

inline Experiment experiment() {
  return parseExperiment(std::string(kRobustnessExperiment), "damage.toml");
}

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
