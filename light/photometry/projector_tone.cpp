#include "light/photometry/projector_tone.hpp"

#include <algorithm>
#include <cmath>

namespace lab::optics {

ProjectorTone::ProjectorTone(double gamma, const std::array<double, 5>& vignetting, double width,
                             double height)
    : plain_(gamma == 1 && vignetting == std::array<double, 5>{}),
      gamma_(gamma),
      vignetting_(vignetting),
      width_(width),
      height_(height) {
  // The minimum of a parabola is at an edge or where it is flat; a fine grid finds both.
  constexpr int kNet = 64;
  for (int i = 0; i <= kNet; ++i) {
    for (int j = 0; j <= kNet; ++j) {
      weakest_ = std::min(weakest_, white({width * i / kNet, height * j / kNet}));
    }
  }
}

double ProjectorTone::white(Place place) const {
  if (plain_) return 1;
  const double a = std::clamp(2 * place.x / width_ - 1, -1.0, 1.0);
  const double b = std::clamp(2 * place.y / height_ - 1, -1.0, 1.0);
  const auto& v = vignetting_;
  return std::max(kDarkest, 1 + v[0] * a + v[1] * b + v[2] * a * a + v[3] * a * b + v[4] * b * b);
}

double ProjectorTone::value(double intensity, Place place) const {
  if (plain_) return intensity;
  return std::pow(std::clamp(intensity * weakest_ / white(place), 0.0, 1.0), 1 / gamma_);
}

double ProjectorTone::light(double value, Place place) const {
  if (plain_) return value;
  return white(place) * std::pow(std::clamp(value, 0.0, 1.0), gamma_);
}

namespace {

constexpr int kSteps = 4096;          // above kCurved, linear interpolation between steps
constexpr double kCurved = 1.0 / 64;  // has an error below 1e-6 for any exponent

}  // namespace

ToneTable::ToneTable(const ProjectorTones& tones)
    : tones_(tones), exponent_(tones.actual.gamma() / tones.assumed.gamma()), powers_(kSteps + 1) {
  for (int i = 0; i <= kSteps; ++i) {
    powers_[static_cast<std::size_t>(i)] = std::pow(static_cast<double>(i) / kSteps, exponent_);
  }
}

double ToneTable::light(double intensity, Place source, Place place) const {
  const ProjectorTone& assumed = tones_.assumed;
  const double share = std::clamp(intensity * assumed.weakest() / assumed.white(source), 0.0, 1.0);
  const double white = tones_.actual.white(place);
  if (share < kCurved) return white * std::pow(share, exponent_);
  const double at = share * kSteps;
  const auto i = std::min(static_cast<std::size_t>(at), powers_.size() - 2);
  return white * (powers_[i] + (at - static_cast<double>(i)) * (powers_[i + 1] - powers_[i]));
}

}  // namespace lab::optics
