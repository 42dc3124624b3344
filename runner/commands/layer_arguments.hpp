/// Layers that somebody writes on the command line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/experiment/light_messages.hpp"

namespace lab::runner {

/// The layers as the experiment's file would have them: the same keys, the same checks, against its
/// robots, programs and light bands. A number alone is uniform light.
///
/// A projector knows the images of its experiment; one that it does not know travels as a grid.
/// @param known the images of the running experiment
/// @param directory that the paths of image files are relative to
/// @throws UserError for layers that are wrong, with what was typed, and for a sequence of unknown
/// images.
[[nodiscard]] std::vector<light::DrivenLayer> parseLayers(const std::vector<std::string>& texts,
                                                          const Experiment& experiment,
                                                          const light::ImageStore& known,
                                                          const std::filesystem::path& directory);

/// What an experiment has to say where the one that runs is not known.
[[nodiscard]] Experiment placeholderExperiment();

}  // namespace lab::runner
