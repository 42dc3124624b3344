/// From intensity to what a pixel is set to.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lab::projector {

/// The identity: 0 dark .. 255 white, rounded as light::toGrey() does. A photometric correction
/// derives from it.
class Tone {
 public:
  Tone() = default;
  Tone(const Tone&) = delete;
  Tone& operator=(const Tone&) = delete;
  virtual ~Tone() = default;

  /// Whether a pixel's place in the picture makes no difference.
  [[nodiscard]] virtual bool isSameEverywhere() const { return true; }

  /// @param intensity of `count` pixels of row y from column x on, 0..1
  /// @param out as many values
  virtual void apply(const double* intensity, int x, int y, std::size_t count,
                     std::uint8_t* out) const;
};

}  // namespace lab::projector
