#include "runner/calibration_lab.hpp"

namespace lab::runner {

Experiment labUnderSteadyLight(Experiment experiment, const std::string& suffix, double duration,
                               double intensity) {
  experiment.name += suffix;
  experiment.duration = duration;
  LayerSpec uniform;
  uniform.intensity = intensity;
  LightStep step;
  step.label = "calibration";
  step.layers = {uniform};
  experiment.light.steps = {step};
  experiment.light.length = 0;
  experiment.light.repeat = false;
  return experiment;
}

}  // namespace lab::runner
