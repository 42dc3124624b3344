/// Light layers on the command line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/experiment/light_messages.hpp"

namespace lab::runner {

/// Parses layers with the keys and checks of experiment files, against the experiment's robots,
/// programs and light bands. A number alone is uniform light.
///
/// The projector has the images of its experiment. Other images are sent as a grid of intensities.
/// @param known the images of the running experiment
/// @param directory to which paths of image files are relative
/// @throws UserError, quoting what was typed, for wrong layers and for a sequence with unknown
/// images
[[nodiscard]] std::vector<light::DrivenLayer> parseLayers(const std::vector<std::string>& texts,
                                                          const Experiment& experiment,
                                                          const light::ImageStore& known,
                                                          const std::filesystem::path& directory);

/// A minimal valid experiment, for a lab whose experiment is not known.
[[nodiscard]] Experiment placeholderExperiment();

}  // namespace lab::runner
