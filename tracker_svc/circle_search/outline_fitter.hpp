/// Size, shape and centre of a candidate, from the outline around it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "light/photometry/imaging.hpp"
#include "tracker_svc/circle_search/candidate.hpp"

namespace lab::detector {

enum class Shape : std::uint8_t { kRound, kLong, kThin, kOther };

class OutlineFitter {
 public:
  OutlineFitter(const optics::Imaging& imaging, const GreyLevels& levels);

  /// Sets the picture of a plane and its rays.
  void aim(Plane& plane, const optics::GreyView& view) const;

  /// Measures the dark area along four axes. Sets `spot` if the shape is round.
  [[nodiscard]] Shape shapeAround(const Plane& plane, const Candidate& candidate, Spot& spot) const;

  /// Centres a faint candidate by the first moments of its darkness.
  /// @param reach [px] around the candidate in which pixels may be read
  /// @return whether its area is that of a circle; sets `spot`
  [[nodiscard]] bool weigh(const Plane& plane, const Candidate& candidate, int reach,
                           Spot& spot) const;

  /// Centres a candidate on its outline, as a big and as a small circle.
  /// @param rejected may be null
  /// @return whether enough outline was found; sets `spot`
  [[nodiscard]] bool settle(const Plane& plane, const Candidate& candidate, Spot& spot,
                            std::vector<RejectedSpot>* rejected) const;

  /// Centres a circle of a given radius [px].
  /// @return the spot if enough of its outline is there
  [[nodiscard]] std::optional<Spot> centredAt(const Plane& plane, float x, float y,
                                              float radius) const;

 private:
  struct Ring {            // outline at a distance from a point
    int outlines = 0;      // directions with an outline near the right distance
    int open = 0;          // pairs of opposite directions without any
    float dx = 0, dy = 0;  // [px] correction of the centre
    float white = 0;       // [DN]
  };

  [[nodiscard]] Ring lookAround(const Plane& plane, float x, float y, float radius,
                                float slack) const;
  [[nodiscard]] int centre(const Plane& plane, float x, float y, float radius, Spot& spot) const;

  float read_noise_ = 0;  // [DN]
  GreyLevels levels_;
  float softness_ = 0;  // [px] standard deviation of blur and pixel
  std::array<float, kRayDirections> cos_{};
  std::array<float, kRayDirections> sin_{};
};

}  // namespace lab::detector
