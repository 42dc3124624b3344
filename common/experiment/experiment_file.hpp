/// Experiment files: docs/experiments.md describes the format, key by key.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/files/experiment_error.hpp"

namespace lab {

/// Reads and checks an experiment file. Every default is filled in, robots are in order of id, and
/// times in the light script count from its start.
/// @param overrides "key=value" each, as after --set: they replace what the file says before it is
/// checked. Keys are paths ("robots[0].x_cm"); a value that is not TOML is taken as text.
/// @throws ExperimentError with up to 20 problems.
[[nodiscard]] Experiment loadExperiment(const std::filesystem::path& file,
                                        const std::vector<std::string>& overrides = {});

/// loadExperiment() of a text that is already at hand, such as the one stored in a log.
/// @param name of the text, for messages.
/// @param directory beside which image files must lie; without it nobody looks for them.
/// @throws ExperimentError
[[nodiscard]] Experiment parseExperiment(
    std::string_view text, const std::string& name, const std::vector<std::string>& overrides = {},
    const std::optional<std::filesystem::path>& directory = {});

/// The experiment as a file in which every default is filled in. parseExperiment() turns it into an
/// equal experiment, to the last bit where the numbers came from a file. (Of numbers that were made
/// in the program about half have no decimal in cm or degrees that gives them exactly; those come
/// back as a neighbour, and from then on unchanged.)
[[nodiscard]] std::string writeExperiment(const Experiment& experiment);

}  // namespace lab
