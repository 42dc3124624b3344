/// What an experiment can need and only a command line may name (docs/security.md).
#pragma once

#include <filesystem>
#include <string>

#include "common/experiment/experiment.hpp"

namespace lab {

/// Sources that the lab executes like code. An experiment file may come from a stranger, so that it
/// cannot name them, and writeExperiment() never writes them.
struct CommandLineSources {
  std::filesystem::path dds_configuration = {};  ///< --dds-configuration, empty: not given
  std::string camera_pipeline = {};              ///< --camera-pipeline, empty: not given
};

/// Enters the sources into an experiment that was read from a file.
/// @param sources a relative path stays relative to the folder of the experiment file
/// @throws ExperimentError if the experiment has no use for one, or contradicts it
void adopt(const CommandLineSources& sources, Experiment& experiment);

/// @throws ExperimentError if the experiment needs the pipeline and the command line gave none
void requirePipeline(const Experiment& experiment);

/// The part of the command line that gives this pipeline to tracker_svc; empty if there is none.
[[nodiscard]] std::string pipelineOf(const Camera& camera);

}  // namespace lab
