#include "tracker_svc/detector/picture_check.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lab::tracker {
namespace {

constexpr int kStep = 16;             // [px] every 16th pixel of every 16th row
constexpr double kFullScale = 255;    // [DN]
constexpr double kLeastSignal = 1.5;  // [DN] mean above black; a cap needs a few DN of contrast
// share of saturated pixels; below it circles are still black
constexpr double kSaturatedShare = 0.4;
constexpr double kBlind = 10;       // [s] black light in scripts is shorter
constexpr double kLeastCircle = 2;  // [px] smaller circles cannot be distinguished from dirt
// [DN] above the assumed black level: black paint in dim light no longer looks black
constexpr double kBlackOff = 6;
constexpr double kLittleLight = 0.25;  // [1] mean brightness below which that matters

}  // namespace

Exposure PictureCheck::look(const optics::GreyView& picture) {
  double sum = 0;
  std::int64_t pixels = 0;
  std::int64_t full = 0;
  std::uint8_t darkest = 255;
  for (int y = kStep / 2; y < picture.height; y += kStep) {
    const std::uint8_t* row = picture.row(y);
    for (int x = kStep / 2; x < picture.width; x += kStep) {
      sum += row[x];
      if (row[x] == 255) ++full;
      darkest = std::min(darkest, row[x]);
      ++pixels;
    }
  }
  Exposure exposure;
  if (pixels == 0) return exposure;
  const double mean = sum / static_cast<double>(pixels);
  exposure.brightness = mean / kFullScale;
  exposure.darkest = darkest;
  exposure.dark = mean - black_ < kLeastSignal;
  exposure.saturated = static_cast<double>(full) > kSaturatedShare * static_cast<double>(pixels);
  if (exposure.dark) ++dark_;
  if (exposure.saturated) ++saturated_;
  return exposure;
}

void BlindCheck::add(double time, const Exposure& exposure, bool any_cap) {
  if (any_cap || pictures_ == 0) {
    since_ = time;
    pictures_ = dark_ = saturated_ = 0;
    darkest_ = kFullScale;
  }
  last_ = time;
  if (any_cap) return;
  ++pictures_;
  if (exposure.dark) ++dark_;
  if (exposure.saturated) ++saturated_;
  darkest_ = std::min(darkest_, exposure.darkest);
  brightness_ = exposure.brightness;
}

std::string BlindCheck::text() const {
  if (pictures_ == 0 || last_ - since_ < kBlind) return {};
  const std::string seen =
      fmt::format("no cap was seen in {} pictures, {:.0f} s: ", pictures_, last_ - since_);
  if (2 * dark_ > pictures_) {
    return seen + fmt::format("{} of them are too dark; more light, exposure or gain?", dark_);
  }
  if (2 * saturated_ > pictures_) {
    return seen + fmt::format("{} of them are too bright; less exposure or gain?", saturated_);
  }
  if (circle_ < kLeastCircle) {
    return seen + fmt::format(
                      "the small circles have a radius of {:.1f} px, needed {:.0f}; more "
                      "pixels?",
                      circle_, kLeastCircle);
  }
  if (darkest_ > black_ + kBlackOff && brightness_ < kLittleLight) {
    return seen + fmt::format(
                      "no pixel is below {:.0f} grey steps in this little light; is the "
                      "camera's black there, and not at {:.0f} (imaging.black_dn in the "
                      "calibration)?",
                      darkest_, black_);
  }
  return seen + "are robots under the camera, is it in focus, does the calibration belong to it?";
}

}  // namespace lab::tracker
