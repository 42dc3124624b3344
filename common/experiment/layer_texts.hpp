/// Light layers that a user types, on the command line or in a program.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/experiment/light_messages.hpp"

namespace lab {

/// Quotes what was typed.
class LayerTextError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Parses layers with the keys and checks of experiment files, against the experiment's robots,
/// programs and light bands. A number alone is uniform light.
///
/// The projector has the images of its experiment. Other images are sent as a grid of intensities.
/// @param known the images of the running experiment
/// @param directory to which paths of image files are relative
/// @throws LayerTextError for wrong layers and for a sequence with unknown images
[[nodiscard]] std::vector<light::DrivenLayer> parseLayerTexts(
    const std::vector<std::string>& texts, const Experiment& experiment,
    const light::ImageStore& known, const std::filesystem::path& directory);

/// A minimal valid experiment, for a lab whose experiment is not known.
[[nodiscard]] Experiment experimentForLayers();

}  // namespace lab
