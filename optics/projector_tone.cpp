#include "optics/projector_tone.hpp"

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
  // A parabola is smallest at an edge or where it is flat; a fine net finds either.
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

}  // namespace lab::optics
