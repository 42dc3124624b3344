// Experiment files: parsing, checks, description, messages. What writeExperiment() writes of a
// valid experiment must be valid too.
#include <cstdint>
#include <string>

#include "common/bus/bus.hpp"
#include "common/experiment/experiment_describe.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/experiment/script_plan.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/files/experiment_error.hpp"
#include "light/field/field.hpp"
#include "tests/fuzz/input.hpp"

namespace lab::fuzz {
namespace {

void use(const Experiment& experiment) {
  static_cast<void>(describeExperiment(experiment));
  static_cast<void>(neededServices(experiment));
  static_cast<void>(hostsInUse(experiment));
  static_cast<void>(encode(lightTableCommand(experiment)));
  static_cast<void>(encode(standCommand(experiment)));
  for (const LightStep& step : experiment.light.steps) {
    static_cast<void>(toMessages(step.layers));
    for (const LayerSpec& layer : step.layers) {
      static_cast<void>(light::validate({toLightLayer(layer)}));
    }
  }
  if (experiment.light.steps.empty()) return;
  ScriptCursor cursor(experiment.light);
  for (int i = 0; i < 100 && !cursor.isLast(); ++i) cursor.advance();
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string text = lab::fuzz::Input(bytes, size).restAsText();
  lab::Experiment experiment;
  try {
    experiment = lab::parseExperiment(text, "fuzz.toml");
  } catch (const lab::ExperimentError&) {
    return 0;
  }
  lab::fuzz::use(experiment);
  const std::string written = lab::writeExperiment(experiment);
  static_cast<void>(lab::parseExperiment(written, "written.toml"));
  return 0;
}
