/// Sets up the screen that shows the light of an experiment.
#pragma once

#include <filesystem>
#include <memory>

#include "common/experiment/experiment.hpp"
#include "common/loop/loop.hpp"
#include "projector_ctl/display/presenter.hpp"

namespace lab::projector {

/// @param directory of the experiment file, which the calibration is relative to
/// @param loop must run in real time, because the display's thread calls its now(), and must
///   outlive the screen
[[nodiscard]] Screen::Setup screenSetup(const Experiment& experiment,
                                        const std::filesystem::path& directory, const Loop& loop,
                                        OpenDisplay open);

/// Opens the display of the experiment. @return null if it is headless
/// @throws DisplayError, ExperimentError if it cannot be opened or the calibration does not fit
[[nodiscard]] std::unique_ptr<Presenter> makePresenter(const Experiment& experiment,
                                                       const std::filesystem::path& directory,
                                                       const Loop& loop);

}  // namespace lab::projector
