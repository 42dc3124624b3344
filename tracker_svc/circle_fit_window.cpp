#include "tracker_svc/circle_fit_window.hpp"

#include <algorithm>
#include <cmath>

namespace lab::tracker::fit {
namespace {

constexpr double kBeyond = 1.0;  // [px] of the outline may lie outside the picture
constexpr Lanes kSteps = {0, 1, 2, 3, 4, 5, 6, 7};

__attribute__((always_inline)) inline void store(float* at, const Lanes& lanes) {
  __builtin_memcpy(at, &lanes, sizeof lanes);
}

// Eight bytes as numbers, by shifts, which compilers do on all lanes at once.
__attribute__((always_inline)) inline Lanes numbers(const std::uint8_t* bytes) {
  int low;
  int high;
  __builtin_memcpy(&low, bytes, 4);
  __builtin_memcpy(&high, bytes + 4, 4);
  const LaneMask words = {low, low, low, low, high, high, high, high};
  constexpr LaneMask kShifts = {0, 8, 16, 24, 0, 8, 16, 24};
  return __builtin_convertvector((words >> kShifts) & 255, Lanes);
}

}  // namespace

__attribute__((target_clones("avx2", "default"))) bool gather(const optics::GreyView& picture,
                                                              double base_x, double base_y,
                                                              const DiscShape& shape, float margin,
                                                              Window& window) {
  // The outline widened by the margin: |M d| < 1 + margin / radius.
  const float* m = shape.m;
  const float widened = 1.0F + margin / shape.radius();
  const float a = m[0] * m[0] + m[2] * m[2];
  const float b = m[0] * m[1] + m[2] * m[3];
  const float c = m[1] * m[1] + m[3] * m[3];
  const float determinant = a * c - b * b;
  const float reach_y = widened * std::sqrt(a / determinant);
  const float reach_x = widened * std::sqrt(c / determinant);
  const int first_row = static_cast<int>(std::ceil(base_y - static_cast<double>(reach_y)));
  const int last_row = static_cast<int>(std::floor(base_y + static_cast<double>(reach_y)));
  const int left = static_cast<int>(std::floor(base_x - static_cast<double>(reach_x)));
  const int right = static_cast<int>(std::ceil(base_x + static_cast<double>(reach_x)));
  const double half_width = static_cast<double>(reach_x / widened);
  const double half_height = static_cast<double>(reach_y / widened);
  if (base_x < half_width - kBeyond || base_x > picture.width - 1 - half_width + kBeyond ||
      base_y < half_height - kBeyond || base_y > picture.height - 1 - half_height + kBeyond) {
    return false;
  }
  // Very large circles: every other row, or fewer, tells enough.
  const int area = (right - left + 1) * (last_row - first_row + 1);
  const int row_step = 1 + area / kMostPixels;

  const float over_a = 1.0F / a;
  window.base_x = base_x;
  window.base_y = base_y;
  int count = 0;
  for (int row = std::max(0, first_row); row <= std::min(last_row, picture.height - 1);
       row += row_step) {
    // a dx^2 + 2 b dx dy + c dy^2 < widened^2
    const float dy = static_cast<float>(row - base_y);
    const float inside = a * widened * widened - dy * dy * determinant;
    if (inside <= 0) continue;
    const float half = std::sqrt(inside) * over_a;
    const float middle = -b * dy * over_a;
    const int from =
        std::max(0, static_cast<int>(std::ceil(base_x + static_cast<double>(middle - half))));
    const int to =
        std::min(picture.width - 1,
                 static_cast<int>(std::floor(base_x + static_cast<double>(middle + half))));
    const std::uint8_t* pixels = picture.row(row);
    const float dx = static_cast<float>(from - base_x);
    for (int column = from; column <= to; column += kLanes) {
      const int at = count + column - from;
      store(window.x + at, kSteps + (dx + static_cast<float>(column - from)));
      store(window.y + at, Lanes{} + dy);
      if (column + kLanes <= picture.width) {
        store(window.value + at, numbers(pixels + column));
      } else {  // nothing may be read beyond the end of the row
        std::uint8_t bytes[kLanes] = {};
        __builtin_memcpy(bytes, pixels + column, static_cast<std::size_t>(picture.width - column));
        store(window.value + at, numbers(bytes));
      }
    }
    count += std::max(0, to - from + 1);
  }
  window.count = (count + kLanes - 1) / kLanes * kLanes;
  for (int at = count; at < window.count; ++at) window.value[at] = kNoPixel;
  return true;
}

}  // namespace lab::tracker::fit
