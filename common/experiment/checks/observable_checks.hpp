/// Checks of regions and of the names of collective numbers.
#pragma once

#include <string>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// @param of_frames only numbers that have a value in every frame are allowed
/// @return whether the name is known
bool checkObservableName(const ExperimentForm& form, const std::string& path,
                         const std::string& name, bool of_frames, Problems& problems);

/// Checks that a collective number which decides about the run is that of all robots.
void checkCrowdSize(const ExperimentForm& form, const std::string& path, Problems& problems);

/// @param program empty: all robots
void checkObservableProgram(const ExperimentForm& form, const std::string& path,
                            const std::string& program, Problems& problems);

/// The crowd rule of a layer.
void checkCrowdRule(const ExperimentForm& form, const std::string& path, const LayerSpec& layer,
                    Problems& problems);

/// The regions of [analysis].
void checkRegions(const ExperimentForm& form, Problems& problems);

/// Checks that the number of twins is none, or large enough for their scatter.
void checkTwins(const ExperimentForm& form, Problems& problems);

}  // namespace lab::keys
