#include "runner/light_by_hand.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/experiment_file.hpp"
#include "runner/exit_code.hpp"

namespace lab::runner {
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

}  // namespace

Experiment experimentByHand() {
  return parseExperiment(R"(
fileversion = 1
name = "by_hand"
duration_s = 1
program = "stand"
[[robots]]
id = 1
[programs.stand]
model = "stand"
)",
                         kHandName);
}

std::vector<light::DrivenLayer> layersByHand(const std::vector<std::string>& texts,
                                             const Experiment& experiment,
                                             const light::ImageStore& known,
                                             const std::filesystem::path& directory) {
  Experiment around = experiment;
  around.light = {};
  const std::string file = fmt::format("{}\n[[light.steps]]\nat_s = 0\nlayers = [{}]\n",
                                       writeExperiment(around), toToml(texts));
  const Experiment read = parseExperiment(file, kHandName, {}, directory);
  std::vector<light::DrivenLayer> layers =
      toDrivenLayers(read.light.steps.front().layers, loadImages(read, directory));
  for (auto& [layer, drive] : layers) {
    const bool unknown_sequence = std::ranges::any_of(
        drive.images, [&](const std::string& image) { return !known.contains(image); });
    if (unknown_sequence) {
      throw UserError(
          "files: a sequence by hand can show only images that the experiment's own script shows; "
          "show one of them with file");
    }
    if (layer.kind != light::LayerKind::kImage || known.contains(layer.image)) continue;
    layer.kind = light::LayerKind::kGrid;
    layer.image.clear();
  }
  return layers;
}

}  // namespace lab::runner
