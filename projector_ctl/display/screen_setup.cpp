#include "projector_ctl/display/screen_setup.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include "common/calibration/light_file.hpp"
#include "common/calibration/projector_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "projector_ctl/display/display_sdl.hpp"
#include "projector_ctl/painter/calibrated_tone.hpp"

namespace lab::projector {

Screen::Setup screenSetup(const Experiment& experiment, const std::filesystem::path& directory,
                          const Loop& loop, OpenDisplay open) {
  Screen::Setup setup;
  setup.open = std::move(open);
  setup.place = [experiment, directory](int columns, int rows) {
    const ActiveProjectorCalibration found =
        activeProjectorCalibration(experiment, directory, columns, rows);
    const auto light = activeLightCalibration(experiment, directory);
    if (!light) return Screen::Placement{found.model, found.id};
    return Screen::Placement{found.model, found.id.empty() ? light->id : found.id + " " + light->id,
                             std::make_shared<CalibratedTone>(light->tone(), found.model)};
  };
  setup.safe_field = {{light::Layer{.intensity = experiment.light.safe_intensity}}, {}, 1};
  setup.now = [&loop] { return loop.now(); };
  setup.sleep_until = [&loop](std::int64_t utime) {
    std::this_thread::sleep_for(std::chrono::microseconds(utime - loop.now()));
  };
  setup.overlay = experiment.projector.overlay;
  return setup;
}

std::unique_ptr<Presenter> makePresenter(const Experiment& experiment,
                                         const std::filesystem::path& directory, const Loop& loop) {
  const std::string& display = experiment.projector.display;
  if (display == kHeadless) return nullptr;
  try {
    return std::make_unique<ThreadPresenter>(
        screenSetup(experiment, directory, loop, [display] { return openSdlDisplay(display); }));
  } catch (const DisplayError& error) {  // the experiment's display is missing
    throw ExperimentError({error.what()});
  }
}

}  // namespace lab::projector
