#include "tracker_svc/response_finder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lab::detector {
namespace {

constexpr std::size_t kEnough = 9;  // number of places
constexpr double kApart = 0.03;     // [m] between two places
// [DN] of white from which a sample is final and its black ratio counts. In dimmer light a black
// level that is off by a few grey steps looks like grey paint.
constexpr double kBrightEnough = 120;
constexpr double kBright = 60;
constexpr std::size_t kThird = 2;  // index by brightness: a reflection brightens one or two places
constexpr double kAsBright = 0.7;  // [1] of the white at kThird from which samples count
// [1] times the former white: the light at that place has changed
constexpr double kBrighter = 1.2;
constexpr double kLead = 0.04;  // [1] share of the places, and
// number of places, by which one assumption must find more than the other
constexpr double kLeastLead = 2;
// [1] black paint over white: 0.05 to 0.15 linear, a quarter to a half gamma-encoded, lower again
// if the camera sharpens
constexpr double kMostLinear = 0.2;
// The first pictures are all examined, later ones less and less often, but at least one in kOneIn.
constexpr std::int64_t kAllOf = 30;
constexpr std::int64_t kOneIn = 100;

optics::Imaging with(optics::Imaging imaging, double gamma) {
  imaging.gamma = gamma;
  return imaging;
}

bool isAt(const auto& one, const auto& other) {
  return std::hypot(one.x - other.x, one.y - other.y) < kApart;
}

bool isAmong(const Detection& cap, const std::vector<Detection>& others) {
  return std::ranges::any_of(others, [&](const Detection& other) { return isAt(cap, other); });
}

}  // namespace

ResponseFinder::ResponseFinder(const optics::CameraModel& camera, const optics::CapGeometry& cap,
                               const optics::Imaging& imaging)
    : linear_(camera, cap, with(imaging, 1)),
      encoded_(camera, cap, with(imaging, optics::kVideoGamma)),
      video_(optics::kVideoGamma, imaging.black),
      black_(imaging.black) {}

void ResponseFinder::setCompressed(bool compressed) {
  linear_.setCompressed(compressed);
  encoded_.setCompressed(compressed);
}

void ResponseFinder::examine(const optics::GreyView& picture) {
  if (settled_) return;
  const std::int64_t number = pictures_++;
  if (number % std::clamp<std::int64_t>(number / kAllOf, 1, kOneIn) != 0) return;
  const std::vector<Detection>& linear = linear_.search(picture);
  const std::vector<Detection>& encoded = encoded_.search(picture);
  for (const Detection& cap : linear) {
    add(paintOf(cap, optics::CameraResponse(), isAmong(cap, encoded) ? By::kBoth : By::kLinear));
  }
  for (const Detection& cap : encoded) {
    if (!isAmong(cap, linear)) add(paintOf(cap, video_, By::kEncoded));
  }
  const auto bright = std::ranges::count_if(
      samples_, [](const Paint& sample) { return sample.white > kBrightEnough; });
  settled_ = static_cast<std::size_t>(bright) >= kEnough;
}

ResponseFinder::Paint ResponseFinder::paintOf(const Detection& cap,
                                              const optics::CameraResponse& read, By by) const {
  const auto shown = [&](float light) {
    return read.grey(static_cast<double>(light) + black_) - black_;
  };
  const double white = std::max(shown(cap.white), 1.0);
  return {cap.x, cap.y, white, shown(cap.white * cap.ratio) / white, by};
}

void ResponseFinder::add(const Paint& paint) {
  const auto before =
      std::ranges::find_if(samples_, [&](const Paint& sample) { return isAt(sample, paint); });
  if (before != samples_.end()) {
    if (paint.white < kBrighter * before->white) return;
    samples_.erase(before);
  }
  const auto place = std::ranges::find_if(
      samples_, [&](const Paint& sample) { return sample.white < paint.white; });
  samples_.insert(place, paint);
}

std::span<const ResponseFinder::Paint> ResponseFinder::brightest() const {
  if (samples_.empty()) return {};
  const double bright = kAsBright * samples_[std::min(kThird, samples_.size() - 1)].white;
  const auto end =
      std::ranges::find_if(samples_, [&](const Paint& sample) { return sample.white < bright; });
  return {samples_.begin(), end};
}

std::int64_t ResponseFinder::lead() const {
  const std::span<const Paint> caps = brightest();
  const std::int64_t lead = std::ranges::count(caps, By::kEncoded, &Paint::by) -
                            std::ranges::count(caps, By::kLinear, &Paint::by);
  const double least = std::max(kLeastLead, kLead * static_cast<double>(caps.size()));
  return static_cast<double>(std::abs(lead)) >= least ? lead : 0;
}

double ResponseFinder::ratio() const {
  std::vector<double> ratios;
  for (const Paint& paint : brightest()) ratios.push_back(paint.ratio);
  std::ranges::sort(ratios);
  return ratios[(ratios.size() - 1) / 2];
}

std::optional<double> ResponseFinder::gamma() const {
  if (const std::int64_t more = lead(); more != 0) return more > 0 ? optics::kVideoGamma : 1;
  if (samples_.empty() || samples_.front().white < kBright) return std::nullopt;
  return ratio() > kMostLinear ? optics::kVideoGamma : 1;
}

std::string ResponseFinder::reason() const {
  if (const std::int64_t more = lead(); more != 0) {
    const By only = more > 0 ? By::kEncoded : By::kLinear;
    return fmt::format("at {} of {} places caps are found only with it",
                       std::ranges::count(brightest(), only, &Paint::by), brightest().size());
  }
  if (!gamma()) return "no cap was bright enough to decide";
  return fmt::format("black paint shows as {:.2f} of the white", ratio());
}

}  // namespace lab::detector
