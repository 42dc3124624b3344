/// Where the middle of a cap is, by its rim alone: the outline of the white disc against the dark
/// line, the body's side or the floor around it.
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
  int seen = 0;     ///< directions, of kRimDirections, in which the rim lies in the picture
  int support = 0;  ///< and in which a rim is there, where the fitted one is
};

inline constexpr int kRimDirections = 48;

/// How much of a rim there is around `centre` [m]: mean over the directions in the picture of the
/// contrast (inside - outside) / (inside + outside), none counting more than a usual rim. 0 where
/// less than a third of the rim lies in the picture. About 0 on bare floor.
[[nodiscard]] float rimAround(const optics::GreyView& picture, const optics::CameraModel& camera,
                              const optics::CapGeometry& cap, const optics::Imaging& imaging,
                              optics::Place centre);

/// Fits a circle of the cap's size to the rim, from `start` [m], which may be a millimetre off. In
/// each direction a profile of three levels (cap, dark line, what is beyond) with two blurred edges
/// is laid through the grey values; directions that disagree with the others, as where something
/// lies over the cap or the other disc, are left out one by one. The covariance follows from how
/// far the directions scatter, and has a floor for what is not the same all round (the body's side
/// is seen on one side of a cap only).
[[nodiscard]] RimFit fitRim(const optics::GreyView& picture, const optics::CameraModel& camera,
                            const optics::CapGeometry& cap, const optics::Imaging& imaging,
                            optics::Place start);

}  // namespace lab::detector
