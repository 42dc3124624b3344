/// The keys of an experiment file, described once. All visitors of visitKeys() share the
/// description: they read the file, write it, recognise unknown keys and print the tables of
/// docs/experiments.md.
#pragma once

#include <cstdint>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/experiment/keys/key_visitor.hpp"
#include "light/field/drive.hpp"

namespace lab::keys {

inline constexpr std::int64_t kFileVersion = 1;
inline constexpr std::int64_t kLargestId = light::kLargestRobot;
inline constexpr std::int64_t kMostRobots = kLargestId;
inline constexpr std::size_t kMostCameras = 8;
inline constexpr double kLongestRun = 864000;  ///< [s] ten days

/// Passes every key of the file to the visitor, in the order in which they are written.
void visitKeys(KeyVisitor& visitor, ExperimentForm& form);

}  // namespace lab::keys
