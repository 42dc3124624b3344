#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "projector_ctl/calibration/adjust_service.hpp"
#include "projector_ctl/display/display_sdl.hpp"
#include "projector_ctl/display/screen_setup.hpp"
#include "projector_ctl/projector_service.hpp"

namespace {

void printDisplays(std::int64_t /*count*/) {
  try {
    std::fputs(describe(lab::projector::listDisplays()).c_str(), stdout);
  } catch (const lab::projector::DisplayError& error) {
    std::fprintf(stderr, "projector_ctl: %s\n", error.what());
    throw CLI::RuntimeError(2);
  }
  throw CLI::Success();
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path pictures;
  std::filesystem::path adjusted;
  lab::ServiceDescription description = lab::projector::serviceDescription();
  description.add_options = [&](CLI::App& app) {
    app.add_option("--pictures", pictures,
                   "Folder in which a PNG of every projected field is saved");
    app.add_flag_function("--list-displays", printDisplays,
                          "List number, name, size, refresh rate and position of every display");
    app.add_option(
        "--adjust", adjusted,
        "Adjust the arena's corners with the keyboard and save them in this calibration file");
  };
  description.make = [&](const lab::ServiceContext& context) -> std::unique_ptr<lab::Service> {
    using namespace lab::projector;
    if (!adjusted.empty()) {
      const std::string display = context.experiment.projector.display;
      return std::make_unique<AdjustService>(context, adjusted, [&] {
        return openSdlDisplay(display == lab::kHeadless ? "0" : display);
      });
    }
    return std::make_unique<ProjectorService>(
        context, pictures, makePresenter(context.experiment, context.directory, context.loop));
  };
  return lab::serviceMain(argc, argv, description);
}
