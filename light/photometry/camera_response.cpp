#include "light/photometry/camera_response.hpp"

#include <cmath>
#include <cstddef>

namespace lab::optics {
namespace {

constexpr double kFullScale = 255;  // [DN]

}  // namespace

CameraResponse::CameraResponse(double gamma, double black) : gamma_(gamma), black_(black) {
  for (std::size_t step = 0; step < steps_.size(); ++step) {
    steps_[step] = static_cast<std::uint8_t>(std::lround(light(static_cast<double>(step))));
  }
}

double CameraResponse::raised(double value, double power) const {
  if (value <= black_) return value;
  const double range = kFullScale - black_;
  return black_ + range * std::pow((value - black_) / range, power);
}

double CameraResponse::light(double grey) const { return raised(grey, gamma_); }

double CameraResponse::grey(double light) const { return raised(light, 1 / gamma_); }

GreyView CameraResponse::linear(const GreyView& picture) {
  if (isLinear()) return picture;
  if (image_.width != picture.width || image_.height != picture.height) {
    image_ = GreyImage(picture.width, picture.height);
  }
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* from = picture.row(y);
    std::uint8_t* to = image_.row(y);
    for (int x = 0; x < picture.width; ++x) to[x] = steps_[from[x]];
  }
  return image_.view();
}

}  // namespace lab::optics
