/// The light of a script as pictures, without running anything.
#pragma once

#include <cstdint>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/experiment/light_messages.hpp"
#include "light/optics/rgb_image.hpp"
#include "projector_ctl/scene.hpp"

namespace lab::runner {

/// Robots stand where they start, those without a place of their own where the simulator puts them;
/// layers that follow them, and trails, are drawn there. Gates that ask for a program are open.
class LightPreview {
 public:
  /// @param images of the experiment's script.
  LightPreview(const Experiment& experiment, const ExperimentImages& images);

  LightPreview(const LightPreview&) = delete;
  LightPreview& operator=(const LightPreview&) = delete;

  /// How long the step is shown [s], at the latest.
  [[nodiscard]] double length(std::size_t step) const;

  /// How long one looks at the step to see what it does [s]: the longest period of what moves in
  /// it, at most its length; 0 where nothing does.
  [[nodiscard]] double span(std::size_t step) const;

  /// Moments of the step that show it [s], rising: its light after the ramp, and where it moves
  /// three more of its span.
  [[nodiscard]] std::vector<double> moments(std::size_t step) const;

  /// The light `time` [s] after the step began. Not earlier than the last call for this step.
  [[nodiscard]] light::Field field(std::size_t step, double time);

  /// The same as a picture of this width [px], x right and y up, with label and time.
  [[nodiscard]] tracker::RgbImage picture(std::size_t step, double time, int width);

  [[nodiscard]] std::size_t steps() const { return experiment_.light.steps.size(); }

 private:
  struct Step {
    projector::Scene scene;
    projector::RobotTracks robots{};
    double seen = -1;  ///< [s] until when the robots stood there
  };

  [[nodiscard]] std::vector<light::Layer> layers(std::size_t step, double time);
  void mark(tracker::RgbImage& image, int top) const;

  const Experiment& experiment_;
  projector::SceneContext scene_context_;
  projector::ObservedFrame standing_;
  std::vector<Step> steps_;
};

}  // namespace lab::runner
