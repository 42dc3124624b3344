#include "common/experiment/command_line_sources.hpp"

#include <string_view>

#include "common/camera/camera_source.hpp"
#include "common/experiment/checks/network_checks.hpp"
#include "common/files/experiment_error.hpp"
#include "common/files/file_problems.hpp"
#include "common/files/file_values.hpp"

namespace lab {
namespace {

constexpr std::size_t kMostLines = 20;

void adoptConfiguration(const std::filesystem::path& file, Experiment& experiment) {
  const std::string option = "--dds-configuration " + file.string();
  if (!experiment.gateway.ros) {
    throw ExperimentError({option + ": found an experiment without ROS 2, expected gateway.ros = "
                                    "true; leave the option out, or add the key"});
  }
  experiment.gateway.configuration = file.string();
  keys::Problems problems([&option](const std::string&) { return keys::FileLocation{option, 0}; });
  keys::checkGateway(experiment, problems);
  if (!problems.empty()) throw ExperimentError(problems.lines(kMostLines));
}

void adoptPipeline(const std::string& pipeline, Camera& camera) {
  if (camera.source != kPipelineCamera) {
    throw ExperimentError(
        {"--camera-pipeline: found camera.camera = " + keys::tomlString(camera.source) +
         ", expected \"" + kPipelineCamera + "\"; leave the option out, or change the key"});
  }
  camera.source = kPipelinePrefix + pipeline;
}

}  // namespace

void adopt(const CommandLineSources& sources, Experiment& experiment) {
  if (!sources.dds_configuration.empty()) adoptConfiguration(sources.dds_configuration, experiment);
  if (!sources.camera_pipeline.empty()) adoptPipeline(sources.camera_pipeline, experiment.camera);
}

void requirePipeline(const Experiment& experiment) {
  if (experiment.camera.source != kPipelineCamera) return;
  throw ExperimentError({std::string("camera.camera: found \"") + kPipelineCamera +
                         "\" and no pipeline, expected it on the command line: "
                         "--camera-pipeline \"ELEMENT ! ...\" (docs/cameras.md)"});
}

std::string pipelineOf(const Camera& camera) {
  const std::string_view prefix = kPipelinePrefix;
  return camera.source.starts_with(prefix) ? camera.source.substr(prefix.size()) : std::string();
}

}  // namespace lab
