/// Maps light intensity to pixel values.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lab::projector {

/// The linear map: 0 dark .. 255 white, rounded as in light::toGrey(). Photometric corrections are
/// derived classes.
class Tone {
 public:
  Tone() = default;
  Tone(const Tone&) = delete;
  Tone& operator=(const Tone&) = delete;
  virtual ~Tone() = default;

  /// Whether the map is the same for all pixels.
  [[nodiscard]] virtual bool isSameEverywhere() const { return true; }

  /// @param intensity of `count` pixels in row y from column x on, 0..1
  /// @param out `count` values
  virtual void apply(const double* intensity, int x, int y, std::size_t count,
                     std::uint8_t* out) const;
};

}  // namespace lab::projector
