#include "tracker_svc/circle_fit/circle_fit_saturated.hpp"

#include <algorithm>

#include "tracker_svc/circle_fit/circle_fit_lanes.hpp"
#include "tracker_svc/detector/saturation.hpp"

namespace lab::detector::fit {
namespace {

constexpr double kManyFull = 0.2;  // [1] of the pixels
constexpr float kBrightest = 6;    // [1] times the brightest value of the camera
constexpr int kHalvings = 10;

}  // namespace

LAB_FIT_CLONES
void startSaturated(Window& window, const Constants& constants, Disc& disc) {
  const float most = kMaxDn - constants.black;
  Lanes pixels = {};
  Lanes full = {};
  Lanes seen = {};
  for (int at = 0; at < window.count; at += kLanes) {
    const Lanes value = loadLanes(window.value + at);
    const LaneMask some = value != kNoPixel;
    pixels += some ? Lanes{} + 1.0F : Lanes{};
    full += value >= kMaxDn ? Lanes{} + 1.0F : Lanes{};
    seen += some ? value - constants.black : Lanes{};
  }
  if (!(total(full) > kManyFull * total(pixels))) return;
  for (int at = 0; at < window.count; at += kLanes) {
    Paint paint;
    paintAt(loadLanes(window.x + at), loadLanes(window.y + at), disc, constants, 1.0F / disc.sigma,
            paint);
    const LaneMask some = loadLanes(window.value + at) != kNoPixel;
    const Lanes lightness = kUsualRatio + (1 - kUsualRatio) * paint.share;
    storeLanes(window.light + at, some ? lightness : Lanes{});
  }
  // The brightness of the window increases with the white level unless all of it is saturated.
  float low = most;
  float high = kBrightest * most;
  for (int i = 0; i < kHalvings; ++i) {
    const float middle = 0.5F * (low + high);
    Lanes expected = {};
    for (int at = 0; at < window.count; at += kLanes) {
      expected += atMost(middle * loadLanes(window.light + at), most);
    }
    (total(expected) < total(seen) ? low : high) = middle;
  }
  disc.white = 0.5F * (low + high);
  disc.ratio = kUsualRatio;
}

}  // namespace lab::detector::fit
