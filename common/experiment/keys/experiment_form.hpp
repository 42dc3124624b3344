/// An experiment as its file says it: some things there may be said in more than one way.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::keys {

/// One [[robots]]: one robot, or several with consecutive ids.
struct RobotEntry {
  std::int64_t id = 0;
  std::int64_t count = 1;
  Body body = Body::kSim;
  std::optional<double> x;      ///< [m]
  std::optional<double> y;      ///< [m]
  std::optional<double> theta;  ///< [rad]
  std::int64_t uid = 0;
  std::string log;
  std::int64_t recorded_id = 0;  ///< 0: id
  double from = 0;               ///< [s]
};

/// A layer in a list of layers.
struct LayerEntry {
  LayerSpec layer{};          ///< all but x, y, and what follows
  std::optional<double> x{};  ///< [m] the middle of the arena, or the robot's, where not given
  std::optional<double> y{};  ///< [m]
  double speed = 0;           ///< [m/s] of a wave's crests
  double change = 0;          ///< [1/s] of noise
  std::string program{};      ///< whose light is the intensity, empty: the layer's own
};

/// One [[light.steps]]: `at` or `hold`.
struct StepEntry {
  std::string label;
  std::optional<double> at;    ///< [s]
  std::optional<double> hold;  ///< [s] at most, where there is a condition
  bool has_until = false;
  Until until;
  IfNot if_not = IfNot::kNext;
  std::string back_to;
  std::int64_t times = 0;
  double ramp = 0;  ///< [s]
  std::vector<LayerEntry> layers;
};

struct ExperimentForm {
  Experiment common;                   ///< all but robots and the light's steps and length
  std::string program;                 ///< shorthand for a light table of one band, empty: none
  std::vector<RobotEntry> robots;      ///< in the order of the file
  std::vector<StepEntry> light_steps;  ///< in the order of the file
  std::optional<double> light_length;  ///< [s]
};

/// What the shorthand `program` stands for.
inline constexpr double kShorthandLight = 0.5;  ///< [1] uniform, where no light is given

/// The entries a program name, a lone light and so on stand for, filled in. Needs no valid form.
void expandShorthand(ExperimentForm& form);

/// When each step begins [s], at the latest; the last element is when the last one ends, infinite
/// where nothing says so. Sums of hold times are rounded to the microsecond.
[[nodiscard]] std::vector<double> stepTimes(const ExperimentForm& form);

/// The light script without its times: LightStep::at and hold, LightScript::length.
[[nodiscard]] LightScript scriptOf(const ExperimentForm& form);

/// The middle of the band that selects the program, where one does [1].
[[nodiscard]] std::optional<double> lightFor(const LightTable& table, const std::string& program);

/// @param common the experiment around it: its arena and its light table are read.
[[nodiscard]] LayerSpec toLayer(const LayerEntry& entry, const Experiment& common);

/// The entry that toLayer() turns into `layer`.
[[nodiscard]] LayerEntry toEntry(const LayerSpec& layer);

/// @param form that has passed the checks.
[[nodiscard]] Experiment toExperiment(const ExperimentForm& form);

/// The form that toExperiment() turns into `experiment`.
[[nodiscard]] ExperimentForm toForm(const Experiment& experiment);

}  // namespace lab::keys
