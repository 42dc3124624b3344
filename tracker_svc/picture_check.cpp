#include "tracker_svc/picture_check.hpp"

namespace lab::tracker {
namespace {

constexpr int kStep = 16;               // [px] every 16th pixel of every 16th row
constexpr double kFullScale = 255;      // [DN]
constexpr double kLeastSignal = 1.5;    // [DN] mean above black; a cap needs a few DN of contrast
constexpr double kSaturatedShare = 0.4; // caps and floor at full scale: circles are still black

}  // namespace

Exposure PictureCheck::look(const optics::GreyView& picture) {
  double sum = 0;
  std::int64_t pixels = 0;
  std::int64_t full = 0;
  for (int y = kStep / 2; y < picture.height; y += kStep) {
    const std::uint8_t* row = picture.row(y);
    for (int x = kStep / 2; x < picture.width; x += kStep) {
      sum += row[x];
      if (row[x] == 255) ++full;
      ++pixels;
    }
  }
  Exposure exposure;
  if (pixels == 0) return exposure;
  const double mean = sum / static_cast<double>(pixels);
  exposure.brightness = mean / kFullScale;
  exposure.dark = mean - black_ < kLeastSignal;
  exposure.saturated = static_cast<double>(full) > kSaturatedShare * static_cast<double>(pixels);
  if (exposure.dark) ++dark_;
  if (exposure.saturated) ++saturated_;
  return exposure;
}

}  // namespace lab::tracker
