/// An experiment as its file says it: some things there may be said in more than one way.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment.hpp"

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

struct LayerEntry {
  LayerSpec layer;          ///< all but x and y
  std::optional<double> x;  ///< [m] the middle of the arena where not given
  std::optional<double> y;  ///< [m]
};

/// One [[light.steps]]: `at` or `hold`.
struct StepEntry {
  std::string label;
  std::optional<double> at;    ///< [s]
  std::optional<double> hold;  ///< [s]
  double ramp = 0;             ///< [s]
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

/// When each step begins [s]; the last element is when the last one ends, infinite where nothing
/// says so. Sums of hold times are rounded to the microsecond.
[[nodiscard]] std::vector<double> stepTimes(const ExperimentForm& form);

/// @param form that has passed the checks.
[[nodiscard]] Experiment toExperiment(const ExperimentForm& form);

/// The form that toExperiment() turns into `experiment`.
[[nodiscard]] ExperimentForm toForm(const Experiment& experiment);

}  // namespace lab::keys
