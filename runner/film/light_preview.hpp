/// Draws the light of a script without running the lab.
#pragma once

#include <cstdint>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/experiment/light_messages.hpp"
#include "light/optics/rgb_image.hpp"
#include "projector_ctl/scene.hpp"

namespace lab::runner {

/// The robots stay at their start poses; robots without one stay where the simulator would place
/// them. Layers that follow robots, and trails, are drawn there. Gates on a program are open.
class LightPreview {
 public:
  /// @param images the images of the experiment
  LightPreview(const Experiment& experiment, const ExperimentImages& images);

  LightPreview(const LightPreview&) = delete;
  LightPreview& operator=(const LightPreview&) = delete;

  /// Longest duration of the step [s].
  [[nodiscard]] double length(std::size_t step) const;

  /// Time in which the motion of the step becomes visible [s]: the longest period in it, at most
  /// its length; 0 if the light is constant.
  [[nodiscard]] double span(std::size_t step) const;

  /// Times to show the step at [s], ascending: the end of the ramp and, if the light changes, three
  /// more within the span.
  [[nodiscard]] std::vector<double> moments(std::size_t step) const;

  /// The light `time` [s] after the step began. `time` must not decrease between calls for a step.
  [[nodiscard]] light::Field field(std::size_t step, double time);

  /// The same as a picture `width` [px] wide with x to the right and y up. The arena fills its
  /// width, or its left part if it is more than twice as high as wide (light::pictureSize()).
  /// Label, time and the bands of the light table stand above it; it shows the regions of the
  /// bands, the robots at their start and a scale.
  [[nodiscard]] optics::RgbImage picture(std::size_t step, double time, int width);

  [[nodiscard]] std::size_t steps() const { return experiment_.light.steps.size(); }

 private:
  struct Step {
    projector::Scene scene;
    projector::RobotTracks robots;
    double seen = -1;  ///< [s] time of the last frame that the layers received
  };

  [[nodiscard]] std::vector<light::Layer> layers(std::size_t step, double time);

  const Experiment& experiment_;
  projector::SceneContext scene_context_;
  projector::ObservedFrame start_frame_;
  std::vector<Step> steps_;
};

}  // namespace lab::runner
