#include "runner/commands/layer_arguments.hpp"

#include "common/experiment/layer_texts.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

std::vector<light::DrivenLayer> parseLayers(const std::vector<std::string>& texts,
                                            const Experiment& experiment,
                                            const light::ImageStore& known,
                                            const std::filesystem::path& directory) {
  try {
    return parseLayerTexts(texts, experiment, known, directory);
  } catch (const LayerTextError& error) {
    throw UserError(error.what());
  }
}

Experiment placeholderExperiment() { return experimentForLayers(); }

}  // namespace lab::runner
