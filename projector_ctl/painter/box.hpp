/// A rectangle of a picture.
#pragma once

namespace lab::projector {

/// In pixels; x to the right and y down from the picture's top left pixel.
struct Box {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  [[nodiscard]] bool touches(const Box& other) const {
    return x < other.x + other.width && other.x < x + width && y < other.y + other.height &&
           other.y < y + height;
  }
  bool operator==(const Box&) const = default;
};

}  // namespace lab::projector
