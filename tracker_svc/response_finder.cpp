#include "tracker_svc/response_finder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lab::tracker {
namespace {

constexpr std::size_t kEnough = 9;  // places
constexpr double kApart = 0.03;     // [m]
// [DN] of white in the picture, from which a cap says anything, and from which it says enough
constexpr double kBright = 60;
constexpr double kBrightEnough = 150;
constexpr double kAsBright = 0.7;   // [1] of the brightest white: they decide
constexpr double kBrighter = 1.2;   // [1] than before: the light has changed at that place
// [1] black paint over white: 0.05 to 0.15 in light, 0.22 to 0.42 once that is encoded
constexpr double kMostLinear = 0.2;
// pictures of which all are looked at; later ones ever more seldom, at least one in kOneIn
constexpr std::int64_t kAllOf = 30;
constexpr std::int64_t kOneIn = 100;

optics::Imaging with(optics::Imaging imaging, double gamma) {
  imaging.gamma = gamma;
  return imaging;
}

bool isAt(const auto& one, const auto& other) {
  return std::hypot(one.x - other.x, one.y - other.y) < kApart;
}

}  // namespace

ResponseFinder::ResponseFinder(const optics::CameraModel& camera, const optics::CapGeometry& cap,
                               const optics::Imaging& imaging)
    : linear_(camera, cap, with(imaging, 1)),
      encoded_(camera, cap, with(imaging, optics::kVideoGamma)),
      black_(imaging.black) {}

void ResponseFinder::setCompressed(bool compressed) {
  linear_.setCompressed(compressed);
  encoded_.setCompressed(compressed);
}

void ResponseFinder::take(const optics::GreyView& picture) {
  if (settled_) return;
  const std::int64_t number = pictures_++;
  if (number % std::clamp<std::int64_t>(number / kAllOf, 1, kOneIn) != 0) return;
  const std::vector<Detection>& caps = linear_.search(picture);
  for (const Detection& cap : caps) add(paintOf(cap, optics::Response()));
  const optics::Response video(optics::kVideoGamma, black_);
  for (const Detection& cap : encoded_.search(picture)) {
    if (std::ranges::any_of(caps, [&](const Detection& other) { return isAt(cap, other); })) continue;
    Paint only = paintOf(cap, video);
    only.encoded = true;
    add(only);
  }
  settle();
}

ResponseFinder::Paint ResponseFinder::paintOf(const Detection& cap,
                                              const optics::Response& read) const {
  const auto shown = [&](float light) {
    return read.grey(static_cast<double>(light) + black_) - black_;
  };
  Paint paint{.x = cap.x, .y = cap.y, .white = shown(cap.white)};
  paint.ratio = shown(cap.white * cap.ratio) / std::max(paint.white, 1.0);
  paint.encoded = paint.ratio > kMostLinear;
  return paint;
}

void ResponseFinder::add(const Paint& paint) {
  if (paint.white < kBright) return;
  const auto before =
      std::ranges::find_if(seen_, [&](const Paint& seen) { return isAt(seen, paint); });
  if (before != seen_.end()) {
    if (paint.white < kBrighter * before->white) return;
    seen_.erase(before);
  }
  const auto place =
      std::ranges::find_if(seen_, [&](const Paint& seen) { return seen.white < paint.white; });
  seen_.insert(place, paint);
}

std::span<const ResponseFinder::Paint> ResponseFinder::brightest() const {
  const auto end = std::ranges::find_if(
      seen_, [&](const Paint& seen) { return seen.white < kAsBright * seen_.front().white; });
  return {seen_.begin(), end};
}

void ResponseFinder::settle() {
  const auto bright =
      std::ranges::count_if(seen_, [](const Paint& seen) { return seen.white > kBrightEnough; });
  settled_ = static_cast<std::size_t>(bright) >= kEnough;
}

std::optional<double> ResponseFinder::gamma() const {
  if (seen_.empty()) return std::nullopt;
  const std::span<const Paint> caps = brightest();
  const auto encoded = std::ranges::count_if(caps, &Paint::encoded);
  return 2 * static_cast<std::size_t>(encoded) > caps.size() ? optics::kVideoGamma : 1;
}

double ResponseFinder::ratio() const {
  std::vector<double> ratios;
  for (const Paint& paint : brightest()) ratios.push_back(paint.ratio);
  std::ranges::sort(ratios);
  return ratios.empty() ? 0 : ratios[(ratios.size() - 1) / 2];
}

}  // namespace lab::tracker
