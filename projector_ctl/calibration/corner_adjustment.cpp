#include "projector_ctl/calibration/corner_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "light/optics/bitmap_font.hpp"
#include "light/optics/projector_model.hpp"

namespace lab::projector {

namespace {

constexpr double kGrid = 0.10;      // [m]
constexpr std::uint8_t kDim = 110;  // grey value of a grid line
constexpr std::uint8_t kWhite = 255;
constexpr int kLetterSize = 2;

constexpr double kTo = 1e5;  // [px] longer lines are not drawn

void line(optics::GreyImage& picture, optics::Pixel from, optics::Pixel to, std::uint8_t value,
          int thickness) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  if (!(length < kTo)) return;
  const int steps = std::max(1, static_cast<int>(std::ceil(2 * length)));
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const int x = static_cast<int>(std::lround(from.x + share * (to.x - from.x)));
    const int y = static_cast<int>(std::lround(from.y + share * (to.y - from.y)));
    for (int dy = 0; dy < thickness; ++dy) {
      for (int dx = 0; dx < thickness; ++dx) {
        const int px = x + dx - thickness / 2;
        const int py = y + dy - thickness / 2;
        if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
        picture.row(py)[px] = std::max(picture.row(py)[px], value);
      }
    }
  }
}

}  // namespace

CornerAdjustment::CornerAdjustment(const calibration::ProjectorPlane& plane) : plane_(plane) {
  const double left = 0.05 * plane.columns;
  const double top = 0.05 * plane.rows;
  const double right = plane.columns - 1 - left;
  const double bottom = plane.rows - 1 - top;
  pixels_ = {optics::Pixel{left, bottom}, {right, bottom}, {right, top}, {left, top}};
}

void CornerAdjustment::handle(DisplayEvent event) {
  optics::Pixel& corner = pixels_[selected_];
  switch (event) {
    case DisplayEvent::kTab:
      selected_ = (selected_ + 1) % pixels_.size();
      break;
    case DisplayEvent::kLeft:
    case DisplayEvent::kFastLeft:
      corner.x -= event == DisplayEvent::kLeft ? kStep : kFast;
      break;
    case DisplayEvent::kRight:
    case DisplayEvent::kFastRight:
      corner.x += event == DisplayEvent::kRight ? kStep : kFast;
      break;
    case DisplayEvent::kUp:
    case DisplayEvent::kFastUp:
      corner.y -= event == DisplayEvent::kUp ? kStep : kFast;
      break;
    case DisplayEvent::kDown:
    case DisplayEvent::kFastDown:
      corner.y += event == DisplayEvent::kDown ? kStep : kFast;
      break;
    default:
      break;
  }
}

std::optional<optics::CameraParameters> CornerAdjustment::lens() const {
  return calibration::lensFromCorners(pixels_, plane_);
}

optics::GreyImage CornerAdjustment::picture() const {
  optics::GreyImage picture(plane_.columns, plane_.rows);
  const auto found = lens();
  if (found) {
    // Straight lines stay straight without distortion.
    const optics::ProjectorModel model(*found, plane_.height);
    const auto draw = [&](optics::Place from, optics::Place to, std::uint8_t value, int thickness) {
      line(picture, model.pixelOf(from), model.pixelOf(to), value, thickness);
    };
    const double width = plane_.arena_width;
    const double height = plane_.arena_height;
    for (double x = kGrid; x < width - 0.1 * kGrid; x += kGrid) draw({x, 0}, {x, height}, kDim, 1);
    for (double y = kGrid; y < height - 0.1 * kGrid; y += kGrid) draw({0, y}, {width, y}, kDim, 1);
    draw({0, 0}, {width, 0}, kWhite, 3);
    draw({width, 0}, {width, height}, kWhite, 3);
    draw({width, height}, {0, height}, kWhite, 3);
    draw({0, height}, {0, 0}, kWhite, 3);
  }
  const optics::Pixel& corner = pixels_[selected_];
  constexpr double kArm = 25;  // [px] of the selected corner's cross
  line(picture, {corner.x - kArm, corner.y}, {corner.x + kArm, corner.y}, kWhite, 5);
  line(picture, {corner.x, corner.y - kArm}, {corner.x, corner.y + kArm}, kWhite, 5);
  const char* const text =
      found ? "arrows move, shift: fast, tab: next corner, enter saves, escape twice leaves"
            : "the corners cross";
  const int left = std::max(0, plane_.columns / 2 - 36 * optics::kGlyphWidth * kLetterSize);
  optics::forEachGlyphPixel(text, left, plane_.rows / 2, kLetterSize, [&](int x, int y) {
    if (x >= 0 && y >= 0 && x < picture.width && y < picture.height) picture.row(y)[x] = kWhite;
  });
  return picture;
}

}  // namespace lab::projector
