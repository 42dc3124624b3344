#include "common/experiment/layer_texts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

#include "common/experiment/experiment_file.hpp"

namespace lab {
namespace {

constexpr const char* kHandName = "lab light";

std::string toToml(const std::vector<std::string>& texts) {
  std::string layers;
  for (const std::string& text : texts) {
    const bool number = text.find_first_not_of("0123456789.") == std::string::npos;
    layers += number ? fmt::format("{{kind = \"uniform\", intensity = {}}}, ", text) : text + ", ";
  }
  return layers;
}

/// Removes the place in a file that the user did not write: "lab light:129:
/// light.steps[0].layers[0].kind: " becomes "kind: ". Text that is not a layer at all gets an
/// example of one.
LayerTextError refusal(const std::string& typed, const ExperimentError& error) {
  static const std::regex file("^lab light[0-9:]*: *");
  static const std::regex layer("^light\\.steps\\[0\\]\\.layers\\[0\\]\\.");
  bool has_key = true;
  std::string text;
  for (const std::string& problem : error.problems()) {
    const std::string in_file = std::regex_replace(problem, file, "");
    has_key = has_key && std::regex_search(in_file, layer);
    text += (text.empty() ? "" : "; ") + std::regex_replace(in_file, layer, "");
  }
  if (!has_key) {
    text +=
        "; expected an intensity from 0 to 1, or a layer as in experiment files: "
        "'{kind = \"disk\", x_cm = 60, y_cm = 45, radius_cm = 20, intensity = 1}'";
  }
  return LayerTextError(fmt::format("light '{}': {}", typed, text));
}

}  // namespace

Experiment experimentForLayers() {
  return parseExperiment(R"(
fileversion = 1
name = "by_hand"
duration_s = 1
program = "none"
[[robots]]
id = 1
[programs.none.phases.none]
hold = "forever"
)",
                         kHandName);
}

std::vector<light::DrivenLayer> parseLayerTexts(const std::vector<std::string>& texts,
                                                const Experiment& experiment,
                                                const light::ImageStore& known,
                                                const std::filesystem::path& directory) {
  Experiment around = experiment;
  around.light = {};
  const auto parse = [&](const std::vector<std::string>& some) {
    return parseExperiment(fmt::format("{}\n[[light.steps]]\nat_s = 0\nlayers = [{}]\n",
                                       writeExperiment(around), toToml(some)),
                           kHandName, {}, directory);
  };
  // One by one, so that an error can quote what was typed.
  for (const std::string& text : texts) {
    try {
      static_cast<void>(parse({text}));
    } catch (const ExperimentError& error) {
      throw refusal(text, error);
    }
  }
  const Experiment read = parse(texts);
  std::vector<light::DrivenLayer> layers =
      toDrivenLayers(read.light.steps.front().layers, loadImages(read, directory));
  for (auto& [layer, drive] : layers) {
    const bool unknown_sequence = std::ranges::any_of(
        drive.images, [&](const std::string& image) { return !known.contains(image); });
    if (unknown_sequence) {
      throw LayerTextError(
          "files: found an image that the experiment file does not use; lab light can show a "
          "sequence only of images that it uses, and any single image with file");
    }
    if (layer.kind != light::LayerKind::kImage || known.contains(layer.image)) continue;
    layer.kind = light::LayerKind::kGrid;
    layer.image.clear();
  }
  return layers;
}

}  // namespace lab
