/// An experiment in the structure of its file, which has several ways to write the same.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/experiment/sweep.hpp"

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

/// One layer in a list of layers.
struct LayerEntry {
  LayerSpec layer{};          ///< all except x, y and the fields below
  std::optional<double> x{};  ///< [m] if not given, the middle of the arena or of the robot
  std::optional<double> y{};  ///< [m]
  double speed = 0;           ///< [m/s] of a wave's crests
  double change = 0;          ///< [1/s] of noise
  std::string program{};      ///< its light is the intensity; empty: the layer's own
  bool has_crowd = false;     ///< the key crowd is there
};

/// One [[light.steps]]. It has either `at` or `hold`.
struct StepEntry {
  std::string label;
  std::optional<double> at;    ///< [s]
  std::optional<double> hold;  ///< [s]; the longest one if there is a condition
  bool has_until = false;
  EndCondition until;
  IfNot if_not = IfNot::kNext;
  std::string back_to;
  std::int64_t times = 0;
  double ramp = 0;  ///< [s]
  std::vector<LayerEntry> layers;
};

struct ExperimentForm {
  Experiment common;                   ///< all except robots and the light's steps and length
  std::string program;                 ///< shorthand for a light table of one band, empty: none
  std::vector<RobotEntry> robots;      ///< in the order of the file
  std::vector<StepEntry> light_steps;  ///< in the order of the file
  std::optional<double> light_length;  ///< [s]
  SweepTable sweep;                    ///< is no part of the experiment of a run
  bool recorded = false;               ///< that of a log, which is shown and not executed
};

/// The light that the shorthand `program` stands for.
inline constexpr double kShorthandLight = 0.5;  ///< [1] uniform

/// Replaces the shorthand `program` by the entries it stands for. The form need not be valid.
void expandShorthand(ExperimentForm& form);

/// The latest start of each step [s]; the last element is the end of the last step, infinite if it
/// is not given. Sums of hold times are rounded to the microsecond.
[[nodiscard]] std::vector<double> stepTimes(const ExperimentForm& form);

/// The light script without times: LightStep::at and hold and LightScript::length are not set.
[[nodiscard]] LightScript scriptOf(const ExperimentForm& form);

/// The middle of the light band that selects the program [1]; nothing if no band does.
[[nodiscard]] std::optional<double> lightFor(const LightTable& table, const std::string& program);

/// Converts an entry to a layer.
/// @param common the experiment, for its arena and its light table
[[nodiscard]] LayerSpec toLayer(const LayerEntry& entry, const Experiment& common);

/// The entry that toLayer() converts to `layer`.
[[nodiscard]] LayerEntry toEntry(const LayerSpec& layer);

/// Converts a form that has passed the checks.
[[nodiscard]] Experiment toExperiment(const ExperimentForm& form);

/// The form that toExperiment() converts to `experiment`.
[[nodiscard]] ExperimentForm toForm(const Experiment& experiment);

}  // namespace lab::keys
