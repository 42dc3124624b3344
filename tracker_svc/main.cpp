#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "tracker_svc/camera_devices.hpp"
#include "tracker_svc/tracker_service.hpp"

int main(int argc, char** argv) {
  lab::ServiceDescription description = lab::tracker::serviceDescription();
  description.make_cameras = [](lab::AsioLoop& loop, const std::filesystem::path& folder) {
    return std::make_unique<lab::CameraDevices>(loop, folder);
  };
  lab::CommandLineSources sources;
  description.add_options = [&sources](CLI::App& app) {
    app.add_option("--camera-pipeline", sources.camera_pipeline,
                   "GStreamer pipeline of camera = \"pipeline\": ELEMENT ! ELEMENT ...");
  };
  description.sources = [&sources] { return sources; };
  return lab::serviceMain(argc, argv, description);
}
