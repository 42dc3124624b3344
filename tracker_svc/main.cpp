#include <filesystem>
#include <memory>

#include "tracker_svc/camera_devices.hpp"
#include "tracker_svc/tracker_service.hpp"

int main(int argc, char** argv) {
  lab::ServiceDescription description = lab::tracker::serviceDescription();
  description.make_cameras = [](lab::AsioLoop& loop, const std::filesystem::path& folder) {
    return std::make_unique<lab::CameraDevices>(loop, folder);
  };
  return lab::serviceMain(argc, argv, description);
}
