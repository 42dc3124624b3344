/// Centre of a cap from its rim alone: the outline of the white disc against the dark line, the
/// body's side or the floor.
#pragma once

#include <array>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"

namespace lab::detector {

struct RimFit {
  optics::Place centre;                ///< [m] on the cap plane
  std::array<double, 3> covariance{};  ///< [m^2] xx, xy, yy
  int visible = 0;  ///< directions, of kRimDirections, in which the rim lies in the picture
  int support = 0;  ///< directions with a rim at the fitted place
};

inline constexpr int kRimDirections = 48;

/// Rim contrast around `centre` [m]: mean over the directions in the picture of (inside - outside)
/// / (inside + outside), each limited to a typical contrast. 0 if less than a third of the rim lies
/// in the picture. About 0 on bare floor.
[[nodiscard]] float rimAround(const optics::GreyView& picture, const optics::CameraModel& camera,
                              const optics::CapGeometry& cap, const optics::Imaging& imaging,
                              optics::Place centre);

/// Fits a circle of the cap's size to the rim, from `start` [m], which may be a millimetre off. In
/// each direction a profile of three levels (cap, dark line, background) with two blurred edges is
/// fitted to the grey values. Directions that disagree with the others, where something covers the
/// cap, are removed one by one. The covariance follows from the scatter of the directions, plus a
/// floor for systematic errors (the body's side is visible on one side of a cap only).
[[nodiscard]] RimFit fitRim(const optics::GreyView& picture, const optics::CameraModel& camera,
                            const optics::CapGeometry& cap, const optics::Imaging& imaging,
                            optics::Place start);

}  // namespace lab::detector
