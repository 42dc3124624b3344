#include <filesystem>
#include <memory>

#include "common/camera/shared_cameras.hpp"
#include "sim_svc/sim_service.hpp"

int main(int argc, char** argv) {
  lab::ServiceDescription description = lab::sim::serviceDescription();
  description.make_cameras = [](lab::AsioLoop& loop, const std::filesystem::path& folder) {
    return std::make_unique<lab::SharedCameras>(loop, folder);
  };
  return lab::serviceMain(argc, argv, description);
}
