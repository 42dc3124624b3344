/// Verifies a cap by its rim contrast, to reject two discs on the bare floor. Around a cap there is
/// a dark line: the gap to the body's edge, the body's dark side, or its shadow.
#pragma once

#include <cstdint>

#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/detector/scale_map.hpp"

namespace lab::detector {

/// [1] smallest contrast at the rim of a cap; bare floor has 0 +- 0.03.
inline constexpr float kLeastRim = 0.05F;
inline constexpr float kUsualRim = 0.15F;  ///< [1]
/// [DN] assumed white of a saturated cap before a fit has determined it.
inline constexpr float kSaturatedWhite = 400;

/// Directions to sample.
enum class RimSampling : std::uint8_t { kAll, kRough };

/// Median over the directions of the contrast (inside - rim) / (inside + rim) at the rim of a cap
/// with its axis at `middle`: about 0 on bare floor, 0.15 and more around a cap in any light. A
/// light edge crosses few directions, so it hardly changes the median. Returns 0 if less than half
/// of the rim lies in the picture. In dim light the median is over sectors. If cap and floor
/// saturate, it is over the unsaturated directions, and 0 if those are few.
/// @param look kRough samples a third of the directions
/// @param white [DN] of the cap above black, if it exceeds saturation
[[nodiscard]] float rimContrast(const optics::GreyView& picture, optics::Pixel middle,
                                const LocalScale& scale, const optics::CapGeometry& cap,
                                const optics::Imaging& imaging,
                                RimSampling look = RimSampling::kAll, float white = 0);

}  // namespace lab::detector
