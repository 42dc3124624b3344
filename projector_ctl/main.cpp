#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "common/text/printable.hpp"
#include "projector_ctl/calibration/adjust_service.hpp"
#include "projector_ctl/display/display_sdl.hpp"
#include "projector_ctl/display/screen_setup.hpp"
#include "projector_ctl/projector_service.hpp"

namespace {

/// Ends the parsing of the command line.
void printDisplays() {
  try {
    std::fputs(lab::printableLines(describe(lab::projector::listDisplays())).c_str(), stdout);
  } catch (const lab::projector::DisplayError& error) {
    std::fprintf(stderr, "projector_ctl: %s\n", lab::printable(error.what()).c_str());
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
    const auto list = [&app](std::int64_t /*count*/) {
      // Words that nothing takes are reported instead, and help is printed instead.
      if (app.remaining_size() == 0 && app.get_help_ptr()->count() == 0) printDisplays();
    };
    app.add_flag_function("--list-displays", list,
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
