#include "projector_ctl/calibration/adjust_service.hpp"

#include <spdlog/spdlog.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/calibration/projector_file.hpp"
#include "common/files/atomic_file.hpp"
#include "light/field/image.hpp"

namespace lab::projector {

namespace {

constexpr std::int64_t kTwice = 1'000'000;  // [us] within which a second Escape ends the program

calibration::ProjectorPlane planeOf(const Experiment& experiment, const DisplayInfo& info) {
  calibration::ProjectorPlane plane;
  plane.columns = info.width;
  plane.rows = info.height;
  plane.arena_width = experiment.arena_width;
  plane.arena_height = experiment.arena_height;
  return plane;
}

}  // namespace

AdjustService::AdjustService(const ServiceContext& context, std::filesystem::path file,
                             const OpenDisplay& open)
    : node_(context.node),
      loop_(context.loop),
      file_(std::move(file)),
      display_(open()),
      corners_(planeOf(context.experiment, display_->info())) {
  plane_ = planeOf(context.experiment, display_->info());
  show();
  loop_.every(kPeriod, loop_.now() + kPeriod, [this] { look(); });
}

void AdjustService::show() {
  const optics::GreyImage picture = corners_.picture();
  const Box whole{0, 0, picture.width, picture.height};
  const optics::GreyView view{picture.pixels.data(), picture.width, picture.height, picture.width};
  display_->present(view, {&whole, 1});
}

void AdjustService::look() {
  bool moved = false;
  for (const DisplayEvent event : display_->events()) {
    const bool closed = event == DisplayEvent::kClosed || event == DisplayEvent::kGone ||
                        event == DisplayEvent::kResized;
    const bool again = loop_.now() - escape_utime_ <= kTwice;
    if (closed || (event == DisplayEvent::kEscape && again)) {
      spdlog::info("left without saving");
      return loop_.stop();
    }
    if (event == DisplayEvent::kEscape) escape_utime_ = loop_.now();
    if (event == DisplayEvent::kEnter && save()) return loop_.stop();
    corners_.handle(event);
    moved = true;
  }
  if (moved) show();
}

bool AdjustService::save() {
  const auto lens = corners_.lens();
  if (!lens) return false;
  ProjectorCalibration calibration;
  calibration.lens = *lens;
  calibration.height = plane_.height;
  calibration.arena_width = plane_.arena_width;
  calibration.arena_height = plane_.arena_height;
  calibration.method = "corners";
  try {
    replaceFile(file_, projectorFileText(calibration));
  } catch (const std::runtime_error& error) {
    spdlog::error("{}", error.what());
    node_.noteError(error.what());
    return false;
  }
  spdlog::info("saved {}; in the experiment: [projector] calibration = \"{}\"", file_.string(),
               file_.string());
  return true;
}

}  // namespace lab::projector
