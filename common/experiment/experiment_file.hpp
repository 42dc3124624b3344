/// Experiment files: docs/experiments.md describes the format, key by key.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/files/experiment_error.hpp"
#include "common/programs/law_knowledge.hpp"

namespace lab {

/// Reads and checks an experiment file. Defaults are filled in, robots are sorted by id, and times
/// in the light script count from its start.
/// @param overrides "key=value" each, as after --set; they replace values of the file before it is
///   checked. Keys are paths ("robots[0].x_cm"); a value that is not TOML is taken as a text.
/// @param laws what is known of laws; without it, they are not checked
/// @throws ExperimentError with up to 20 problems
[[nodiscard]] Experiment loadExperiment(const std::filesystem::path& file,
                                        const std::vector<std::string>& overrides = {},
                                        const LawKnowledge& laws = {});

/// Reads the experiment of a run to show it, as parseExperiment() reads the one in its log: keys
/// that only whoever executes it must refuse are accepted, and image files are not looked for.
/// @throws ExperimentError with up to 20 problems
[[nodiscard]] Experiment loadRecordedExperiment(const std::filesystem::path& file);

/// As loadExperiment(), from a text such as the one stored in a log.
/// @param name of the text, for messages
/// @param directory of the image files; if none is given, image files are not looked for, and keys
///   that can run code are accepted: the experiment must not be executed
/// @throws ExperimentError
[[nodiscard]] Experiment parseExperiment(std::string_view text, const std::string& name,
                                         const std::vector<std::string>& overrides = {},
                                         const std::optional<std::filesystem::path>& directory = {},
                                         const LawKnowledge& laws = {});

/// The text of an experiment file with all defaults filled in. parseExperiment() gives an equal
/// experiment, to the last bit if its numbers came from a file. About half of all other numbers
/// have no decimal in cm or degrees that gives them exactly; these come back as a neighbouring
/// double, which then remains unchanged.
[[nodiscard]] std::string writeExperiment(const Experiment& experiment);

}  // namespace lab
