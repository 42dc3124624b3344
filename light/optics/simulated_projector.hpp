/// Lens of the simulated projector, with its errors.
#pragma once

#include <optional>

#include "light/optics/projector_model.hpp"

namespace lab::optics {

/// [m] above the floor: height of the light sensors, at which light is specified.
inline constexpr double kSensorHeight = 0.05;

/// Errors of a projector. With all 0 its picture coincides with the arena.
///
/// A distorted picture is zoomed about the arena's middle until it just covers the arena, as in a
/// careful set-up; the offsets are applied after that and may leave corners dark.
struct ProjectorFaults {
  /// Width of the picture at y = 0, the side away from the projector, relative to its width at
  /// y = height, minus 1. At sensor height, before barrel and zoom. Caused by a tilt about the x
  /// axis.
  double keystone = 0;
  /// Relative displacement of a picture's corner towards the middle, before the tilt: k1 of the
  /// lens is barrel / ((1 - barrel)^3 r^2), r the corner's radius.
  double barrel = 0;
  double offset_x = 0;  ///< [m] shift of the picture at sensor height
  double offset_y = 0;  ///< [m]

  bool operator==(const ProjectorFaults&) const = default;
};

/// The projector over an arena of width x height [m], with a picture of columns x rows pixels. Its
/// lens is modelled 2.05 m above sensor height (more over a larger arena) above the arena's middle.
/// Valid for places at sensor height only, as is ProjectorModel.
[[nodiscard]] ProjectorModel simulatedProjector(double width, double height, int columns, int rows,
                                                const ProjectorFaults& faults);

/// Displacement of light if the assumed model of a projector differs from the actual projector.
class ProjectorWarp {
 public:
  /// No displacement.
  ProjectorWarp() = default;

  /// @param assumed model by which the picture is painted
  /// @param actual model of the projector that shows it
  ProjectorWarp(const ProjectorModel& assumed, const ProjectorModel& actual);

  /// Whether no light is displaced, ignoring the picture's edge.
  [[nodiscard]] bool isIdentity() const { return !assumed_; }

  /// The place for which the picture was computed that lights `place`, both at sensor height; empty
  /// outside the picture.
  [[nodiscard]] std::optional<Place> source(Place place) const;

  /// The same without testing the picture's edge.
  [[nodiscard]] std::optional<Place> sourceUnclipped(Place place) const;

  /// Distance [px] of a place from the edge of the picture; negative outside.
  [[nodiscard]] double marginInside(Place place) const;

 private:
  std::optional<ProjectorModel> assumed_;
  std::optional<ProjectorModel> actual_;
};

}  // namespace lab::optics
