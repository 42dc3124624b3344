/// What must fit together in an experiment file, beyond the range of each number.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// The shorthand `program`, before it is expanded.
void checkShorthand(const ExperimentForm& form, Problems& problems);

/// The robots fit on the arena and the programs are what the wheels can do. Looks at nothing that
/// `problems` already concern.
void checkRobots(const ExperimentForm& form, Problems& problems);

/// A camera that is not the simulated one has a calibration.
void checkCamera(const ExperimentForm& form, Problems& problems);

/// The steps follow each other, their conditions can come about. There is at least one step.
void checkScript(const ExperimentForm& form, Problems& problems);

/// What ends the run before its time can come about.
void checkStopRules(const ExperimentForm& form, Problems& problems);

/// The name is that of a program.
void checkProgramName(const ExperimentForm& form, const std::string& path, const std::string& name,
                      Problems& problems);

/// Each layer of each step can be painted, and changes as it can.
/// @param directory of the image files; without it nobody looks for them.
void checkLayers(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                 Problems& problems);

/// The light table and the light script make sense.
/// @param directory of the image files; without it nobody looks for them.
void checkLight(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                Problems& problems);

/// Services are placed on hosts that are named, hosts are joined in a way that works, and nobody
/// opens the lab to a network without saying so.
void checkNetworks(const ExperimentForm& form, Problems& problems);

}  // namespace lab::keys
