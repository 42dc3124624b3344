/// Photometric correction of pixels by tables.
#pragma once

#include <cstdint>
#include <vector>

#include "light/optics/projector_model.hpp"
#include "light/photometry/projector_tone.hpp"
#include "projector_ctl/painter/tone.hpp"

namespace lab::projector {

/// Computes optics::ProjectorTone::value() at the position of every pixel from tables.
class CalibratedTone final : public Tone {
 public:
  CalibratedTone(const optics::ProjectorTone& tone, const optics::ProjectorModel& model);

  [[nodiscard]] bool isSameEverywhere() const override { return false; }
  void apply(const double* intensity, int x, int y, std::size_t count,
             std::uint8_t* out) const override;

 private:
  int columns_;
  std::vector<float> share_;  ///< per pixel: its value for intensity 1
  std::vector<float> curve_;  ///< intensity^(1 / gamma) at equal steps
};

}  // namespace lab::projector
