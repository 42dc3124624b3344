/// Is there a cap, and not two discs on the bare floor? The rim tells: around a cap there is a dark
/// line, the gap to the body's edge, or the body's dark side, or its shadow.
#pragma once

#include <cstdint>

#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/detector/scale_map.hpp"

namespace lab::detector {

/// [1] contrast at the rim of a cap, at least; bare floor has 0 +- 0.03.
inline constexpr float kLeastRim = 0.05F;
inline constexpr float kUsualRim = 0.15F;  ///< [1]
/// [DN] as bright as a cap may be that is full: for a first look, before a fit says it.
inline constexpr float kSaturatedWhite = 400;

/// At how many places of a rim to look.
enum class RimSampling : std::uint8_t { kAll, kRough };

/// Median over the directions of the contrast (inside - rim) / (inside + rim) at the rim of a cap
/// with its axis at `middle`; about 0 on bare floor, 0.15 and more around a cap whatever the light.
/// A light edge touches few directions, so the median does not see it. 0 where less than half of
/// the rim lies in the picture. In little light, where single pixels say nothing, of sectors.
/// Where the cap and the floor are too bright for the camera, of the directions that are not full
/// all along; 0 where those are few.
/// @param look for a first look at many places a third of the directions is enough
/// @param white [DN] of the cap above black, where that is more than the camera can say
[[nodiscard]] float rimContrast(const optics::GreyView& picture, optics::Pixel middle,
                                const LocalScale& scale, const optics::CapGeometry& cap,
                                const optics::Imaging& imaging,
                                RimSampling look = RimSampling::kAll, float white = 0);

}  // namespace lab::detector
