#include "common/calibration/lens_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lab {
namespace {

constexpr double kRotationSlack = 1e-3;  // of R R^T: the error of numbers with three digits

}  // namespace

void checkRotation(const JsonSection& file, const char* key, const std::array<double, 9>& r) {
  double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      double product = i == j ? -1 : 0;
      for (std::size_t k = 0; k < 3; ++k) product += r[3 * i + k] * r[3 * j + k];
      worst = std::max(worst, std::abs(product));
    }
  }
  const double turns = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                       r[2] * (r[3] * r[7] - r[4] * r[6]);
  if (!(worst <= kRotationSlack)) {
    file.fail(key, fmt::format("is no rotation: R R^T differs from 1 by {:.2g}, allowed {:g}",
                               worst, kRotationSlack));
  }
  if (turns < 0) file.fail(key, "is a mirror image, expected a rotation (z of the arena is up)");
}

optics::CameraParameters readLens(const JsonSection& file, bool mirrored) {
  optics::CameraParameters lens;
  lens.width = file.pixels("width_px");
  lens.height = file.pixels("height_px");
  lens.fx = file.number("fx_px", mirrored ? -kMostLensPixels : 1, kMostLensPixels);
  if (std::abs(lens.fx) < 1)
    file.fail("fx_px", fmt::format("found {:g}, expected pixels", lens.fx));
  lens.fy = file.number("fy_px", 1, kMostLensPixels);
  lens.cx = file.number("cx_px", -kMostLensPixels, kMostLensPixels);
  lens.cy = file.number("cy_px", -kMostLensPixels, kMostLensPixels);
  lens.k1 = file.number("k1", -kMostDistortion, kMostDistortion);
  lens.k2 = file.number("k2", -kMostDistortion, kMostDistortion);
  lens.p1 = file.number("p1", -kMostDistortion, kMostDistortion);
  lens.p2 = file.number("p2", -kMostDistortion, kMostDistortion);
  lens.k3 = file.number("k3", -kMostDistortion, kMostDistortion);
  lens.rotation = file.numbers<9>("rotation");
  checkRotation(file, "rotation", lens.rotation);
  lens.translation = file.numbers<3>("translation_m");
  return lens;
}

void writeLens(nlohmann::ordered_json& file, const optics::CameraParameters& lens) {
  file["width_px"] = lens.width;
  file["height_px"] = lens.height;
  file["fx_px"] = lens.fx;
  file["fy_px"] = lens.fy;
  file["cx_px"] = lens.cx;
  file["cy_px"] = lens.cy;
  file["k1"] = lens.k1;
  file["k2"] = lens.k2;
  file["p1"] = lens.p1;
  file["p2"] = lens.p2;
  file["k3"] = lens.k3;
  file["rotation"] = lens.rotation;
  file["translation_m"] = lens.translation;
}

}  // namespace lab
