/// The projector over the simulated arena: what its lens really does.
#pragma once

#include <optional>

#include "light/optics/projector_model.hpp"

namespace lab::optics {

/// [m] above the floor: the light sensors, where all light is meant.
inline constexpr double kSensorHeight = 0.05;

/// What is wrong with a projector. All 0: its picture is the arena, exactly.
///
/// A wrong picture is zoomed about the arena's middle until it just covers the arena, as whoever
/// sets a projector up would do; the offsets come after that, and may leave corners dark.
struct ProjectorFaults {
  /// At sensor height the picture is wider at y = 0, the side away from the projector, than at y =
  /// height by this share: a tilt about an axis along x, before barrel and zoom.
  double keystone = 0;
  /// A corner of the picture falls nearer to the picture's middle by this share of its distance,
  /// before the tilt: k1 of the lens is barrel / ((1 - barrel)^3 r^2), r the corner's radius.
  double barrel = 0;
  double offset_x = 0;  ///< [m] by which the picture is shifted at sensor height
  double offset_y = 0;  ///< [m]

  bool operator==(const ProjectorFaults&) const = default;
};

/// The projector over an arena of width x height [m], with a picture of columns x rows pixels. Its
/// lens is written as one 2.05 m above sensor height (more over a larger arena) in front of the
/// arena's middle: right for places at sensor height, which is all that ProjectorModel speaks of.
[[nodiscard]] ProjectorModel simulatedProjector(double width, double height, int columns, int rows,
                                                const ProjectorFaults& faults);

/// Where light lands when a projector is not what it is believed to be.
class ProjectorWarp {
 public:
  /// Light is where it is wanted.
  ProjectorWarp() = default;

  /// @param believed by who paints the picture, @param real what the projector is
  ProjectorWarp(const ProjectorModel& believed, const ProjectorModel& real);

  /// Whether all light is where it is wanted, whatever the picture's edge.
  [[nodiscard]] bool isIdentity() const { return !believed_; }

  /// The place whose wanted light falls on `place`, both at sensor height; empty where the picture
  /// does not reach.
  [[nodiscard]] std::optional<Place> source(Place place) const;

  /// The same without looking whether the picture reaches.
  [[nodiscard]] std::optional<Place> sourceUnclipped(Place place) const;

  /// How far [px] a place lies inside the picture; negative outside.
  [[nodiscard]] double marginInside(Place place) const;

 private:
  std::optional<ProjectorModel> believed_;
  std::optional<ProjectorModel> real_;
};

}  // namespace lab::optics
