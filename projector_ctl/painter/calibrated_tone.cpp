#include "projector_ctl/painter/calibrated_tone.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lab::projector {
namespace {

constexpr int kSteps =
    1 << 16;  // error below half a grey level even at low intensity, where the curve is steep

}  // namespace

CalibratedTone::CalibratedTone(const optics::ProjectorTone& tone,
                               const optics::ProjectorModel& model)
    : columns_(model.columns()), curve_(kSteps + 2) {
  share_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(model.rows()));
  for (int y = 0; y < model.rows(); ++y) {
    for (int x = 0; x < columns_; ++x) {
      const auto place = model.placeOf({static_cast<double>(x), static_cast<double>(y)});
      share_.push_back(place ? static_cast<float>(tone.value(1, *place)) : 0.0F);
    }
  }
  for (std::size_t i = 0; i < curve_.size(); ++i) {
    curve_[i] = static_cast<float>(std::pow(static_cast<double>(i) / kSteps, 1 / tone.gamma()));
  }
}

void CalibratedTone::apply(const double* intensity, int x, int y, std::size_t count,
                           std::uint8_t* out) const {
  const float* share =
      share_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + x;
  for (std::size_t i = 0; i < count; ++i) {
    const double position = std::clamp(intensity[i], 0.0, 1.0) * kSteps;
    const auto step = static_cast<std::size_t>(position);
    const float rest = static_cast<float>(position - static_cast<double>(step));
    const float value = curve_[step] + rest * (curve_[step + 1] - curve_[step]);
    out[i] = static_cast<std::uint8_t>(255.0F * std::min(1.0F, share[i] * value) + 0.5F);
  }
}

}  // namespace lab::projector
