#include <CLI/CLI.hpp>
#include <memory>

#include "projector_ctl/projector_service.hpp"

int main(int argc, char** argv) {
  std::filesystem::path pictures;
  lab::ServiceDescription description = lab::projector::serviceDescription();
  description.add_options = [&pictures](CLI::App& app) {
    app.add_option("--pictures", pictures, "Folder for a PNG of every field it shows");
  };
  description.make = [&pictures](const lab::ServiceContext& context) {
    return std::make_unique<lab::projector::ProjectorService>(context, pictures);
  };
  return lab::serviceMain(argc, argv, description);
}
