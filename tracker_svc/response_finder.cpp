#include "tracker_svc/response_finder.hpp"

#include <algorithm>
#include <cstddef>

namespace lab::tracker {
namespace {

constexpr std::size_t kEnough = 9;  // caps
// [DN] of white in the picture: in less light a black level that is off by a few steps looks like grey
// paint
constexpr double kBright = 60;
// [1] black paint over white: 0.05 to 0.15 in light, 0.25 to 0.42 once that is encoded
constexpr double kMostLinear = 0.2;
constexpr std::int64_t kAllOf = 30;  // pictures; of later ones one in kOneIn
constexpr std::int64_t kOneIn = 10;

optics::Imaging with(optics::Imaging imaging, double gamma) {
  imaging.gamma = gamma;
  return imaging;
}

}  // namespace

ResponseFinder::ResponseFinder(const optics::CameraModel& camera, const optics::CapGeometry& cap,
                               optics::Imaging imaging)
    : linear_(camera, cap, with(imaging, 1)),
      encoded_(camera, cap, with(imaging, optics::kVideoGamma)),
      black_(imaging.black) {}

void ResponseFinder::setCompressed(bool compressed) {
  linear_.setCompressed(compressed);
  encoded_.setCompressed(compressed);
}

void ResponseFinder::take(const optics::GreyView& picture) {
  if (isSettled()) return;
  const std::int64_t number = pictures_++;
  if (number >= kAllOf && number % kOneIn != 0) return;
  const std::vector<Detection>& caps = linear_.search(picture);
  if (!caps.empty()) return add(caps, optics::Response());
  add(encoded_.search(picture), optics::Response(optics::kVideoGamma, black_));
}

void ResponseFinder::add(const std::vector<Detection>& caps, const optics::Response& read) {
  for (const Detection& cap : caps) {
    const double white = read.grey(static_cast<double>(cap.white) + black_) - black_;
    if (white < kBright) continue;
    const double dark = read.grey(static_cast<double>(cap.white * cap.ratio) + black_) - black_;
    ratios_.insert(std::ranges::upper_bound(ratios_, dark / white), dark / white);
  }
}

std::optional<double> ResponseFinder::gamma() const {
  if (ratios_.empty()) return std::nullopt;
  return ratio() > kMostLinear ? optics::kVideoGamma : 1;
}

bool ResponseFinder::isSettled() const { return ratios_.size() >= kEnough; }

double ResponseFinder::ratio() const {
  return ratios_.empty() ? 0 : ratios_[ratios_.size() / 2];
}

}  // namespace lab::tracker
