/// From an experiment to the screen that shows its light.
#pragma once

#include <filesystem>
#include <memory>

#include "common/experiment/experiment.hpp"
#include "common/loop/loop.hpp"
#include "projector_ctl/display/presenter.hpp"

namespace lab::projector {

/// @param directory of the experiment file: the calibration lies beside it
/// @param loop a live one: its now() is read by the thread that shows pictures; outlives the screen
[[nodiscard]] Screen::Setup screenSetup(const Experiment& experiment,
                                        const std::filesystem::path& directory, const Loop& loop,
                                        OpenDisplay open);

/// The window that the experiment asks for; null: headless.
/// @throws DisplayError, ExperimentError when it cannot be opened or the calibration does not fit
[[nodiscard]] std::unique_ptr<Presenter> makePresenter(const Experiment& experiment,
                                                       const std::filesystem::path& directory,
                                                       const Loop& loop);

}  // namespace lab::projector
