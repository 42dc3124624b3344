#include "projector_ctl/calibration/projector_patterns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace lab::calibration {
namespace {

constexpr double kWholeTurn = 2 * std::numbers::pi;
constexpr double kSaturated = 253;     // [DN]
constexpr double kLeastContrast = 20;  // [DN] between bright and dark
constexpr double kLeastWave = 0.4;     // of the amplitude expected from the contrast
constexpr double kAgree = 0.25;        // of a short wave: allowed deviation of the long wave
constexpr double kWallMargin = 0.003;  // [m] excluded along the arena's border

constexpr double kLeastSigma = 1e-4;  // [px]

/// Fits a paraboloid to the values of a square's pixels: the curvature of the lenses would displace
/// a mean by up to 0.03 mm.
class SquareFit {
 public:
  void add(int x, int y, double value) {
    const double a = x - kMiddle;
    const double b = y - kMiddle;
    sum_ += value;
    squares_ += value * value;
    slope_x_ += value * a;
    slope_y_ += value * b;
    twist_ += value * a * b;
    bend_x_ += value * (a * a - kSpread);
    bend_y_ += value * (b * b - kSpread);
  }

  /// Value in the middle of the square.
  [[nodiscard]] double middle() const {
    return sum_ / kPixels - kSpread * (bend_x_ + bend_y_) / kBend;
  }

  /// Variance of middle(), from the residuals.
  [[nodiscard]] double variance() const {
    const double left = squares_ - sum_ * sum_ / kPixels -
                        (slope_x_ * slope_x_ + slope_y_ * slope_y_) / (kSpread * kPixels) -
                        twist_ * twist_ / (kSpread * kSpread * kPixels) -
                        (bend_x_ * bend_x_ + bend_y_ * bend_y_) / kBend;
    return std::max(0.0, left) / (kPixels - 6) * (1 / kPixels + 2 * kSpread * kSpread / kBend);
  }

 private:
  // With n pixels along a side: mean of x^2, and the sum of (x^2 - its mean)^2.
  static constexpr double kSide = PatternReader::kBlock;
  static constexpr double kMiddle = (kSide - 1) / 2;
  static constexpr double kPixels = kSide * kSide;
  static constexpr double kSpread = (kPixels - 1) / 12;
  static constexpr double kBend = kPixels * (kPixels - 1) * (kPixels - 4) / 180;
  double sum_ = 0, squares_ = 0, slope_x_ = 0, slope_y_ = 0, twist_ = 0, bend_x_ = 0, bend_y_ = 0;
};

double periodOf(std::size_t wave, double arena_width, double arena_height) {
  if (wave % 2 == 1) return kShortWave;
  return kLongWave * (wave == 0 ? arena_width : arena_height);
}

}  // namespace

std::vector<LightPattern> projectorPatterns(double arena_width, double arena_height) {
  std::vector<LightPattern> patterns(2);
  patterns[1].kind = LightPattern::Kind::kBright;
  patterns[1].layer.intensity = 1;
  for (std::size_t wave = 0; wave < kWaves; ++wave) {
    for (int i = 0; i < kPhases; ++i) {
      LightPattern& pattern = patterns.emplace_back();
      pattern.kind = LightPattern::Kind::kWave;
      pattern.wave = wave;
      pattern.phase = kWholeTurn * i / kPhases;
      light::Layer& layer = pattern.layer;
      layer.kind = light::LayerKind::kWave;
      layer.x = arena_width / 2;
      layer.y = arena_height / 2;
      layer.angle = wave < 2 ? 0 : std::numbers::pi / 2;
      layer.size = periodOf(wave, arena_width, arena_height);
      layer.phase = pattern.phase;
      layer.intensity = 1;
      layer.intensity2 = 0;
    }
  }
  return patterns;
}

PatternReader::PatternReader(const PatternView& view, const std::vector<LightPattern>& patterns)
    : view_(view), camera_(view.camera), patterns_(patterns), pictures_(patterns.size()) {
  if (view.projector) {
    if (!((*view.projector)[2] > std::max(view.surface, view.plane.height))) {
      throw std::invalid_argument("the projector is not above the lit surface");
    }
  } else if (std::abs(view.surface - view.plane.height) > 1e-3) {
    throw std::invalid_argument("the surface is not at the height of the light sensors");
  }
  const auto size =
      static_cast<std::size_t>(view.camera.width) * static_cast<std::size_t>(view.camera.height);
  dark_.resize(size);
  bright_.resize(size);
  for (std::size_t wave = 0; wave < kWaves; ++wave) {
    cosines_[wave].resize(size);
    sines_[wave].resize(size);
  }
  saturated_.resize(size);
  in_arena_.resize(size);
  for (int y = 0; y < view.camera.height; ++y) {
    for (int x = 0; x < view.camera.width; ++x) {
      const auto place =
          camera_.toPlane({static_cast<double>(x), static_cast<double>(y)}, view.surface);
      in_arena_[static_cast<std::size_t>(y) * static_cast<std::size_t>(view.camera.width) +
                static_cast<std::size_t>(x)] =
          place && place->x > kWallMargin && place->x < view.plane.arena_width - kWallMargin &&
          place->y > kWallMargin && place->y < view.plane.arena_height - kWallMargin;
    }
  }
}

void PatternReader::add(std::size_t index, const optics::GreyView& grey) {
  if (grey.width != view_.camera.width || grey.height != view_.camera.height) {
    throw std::invalid_argument(
        "a picture whose size differs from that of the camera's calibration");
  }
  const LightPattern& pattern = patterns_.at(index);
  ++pictures_[index];
  const auto c = static_cast<float>(std::cos(pattern.phase));
  const auto s = static_cast<float>(std::sin(pattern.phase));
  std::size_t at = 0;
  for (int y = 0; y < grey.height; ++y) {
    const std::uint8_t* row = grey.row(y);
    for (int x = 0; x < grey.width; ++x, ++at) {
      const auto value = static_cast<float>(row[x]);
      if (value >= static_cast<float>(kSaturated)) saturated_[at] = true;
      if (pattern.kind == LightPattern::Kind::kWave) {
        cosines_[pattern.wave][at] += c * value;
        sines_[pattern.wave][at] += s * value;
      } else {
        (pattern.kind == LightPattern::Kind::kDark ? dark_ : bright_)[at] += value;
      }
    }
  }
}

bool PatternReader::isClear(std::size_t at) const {
  return in_arena_[at] && !saturated_[at] && projectorPixel(at).has_value();
}

/// Empty if the waves are not clear.
std::optional<optics::Pixel> PatternReader::projectorPixel(std::size_t at) const {
  const double frames = std::max(1, pictures_.front());
  const double contrast = static_cast<double>(bright_[at] - dark_[at]) / frames;
  if (contrast < kLeastContrast) return std::nullopt;
  std::array<double, 2> found{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double along = 0;  // [m] from the arena's middle
    for (std::size_t wave = 2 * axis; wave < 2 * axis + 2; ++wave) {
      const auto c = static_cast<double>(cosines_[wave][at]);
      const auto s = static_cast<double>(sines_[wave][at]);
      const double amplitude = 2 * std::hypot(c, s) / (kPhases * frames);
      if (amplitude < kLeastWave * contrast / 2) return std::nullopt;
      const double period = periodOf(wave, view_.plane.arena_width, view_.plane.arena_height);
      const double here = std::atan2(s, c) / kWholeTurn * period;
      if (wave % 2 == 0) {
        along = here;
        continue;
      }
      const double fine = here + period * std::round((along - here) / period);
      if (std::abs(fine - along) > kAgree * period) return std::nullopt;
      along = fine;
    }
    found[axis] = along;
  }
  return view_.assumed.pixelOf(
      {view_.plane.arena_width / 2 + found[0], view_.plane.arena_height / 2 + found[1]});
}

/// At the plane's height: where the light for that pixel crosses the plane.
std::optional<optics::Place> PatternReader::placeOf(optics::Pixel pixel) const {
  auto place = camera_.toPlane(pixel, view_.surface);
  if (!place || !view_.projector) return place;
  const auto& from = *view_.projector;
  const double scale = (from[2] - view_.plane.height) / (from[2] - view_.surface);
  return optics::Place{from[0] + scale * (place->x - from[0]),
                       from[1] + scale * (place->y - from[1])};
}

std::vector<bool> PatternReader::clearPixels() const {
  std::vector<bool> clear(in_arena_.size());
  for (std::size_t at = 0; at < clear.size(); ++at) clear[at] = isClear(at);
  return clear;
}

std::vector<ProjectorObservation> PatternReader::observations() const {
  const int width = view_.camera.width;
  const int height = view_.camera.height;
  const std::vector<bool> clear = clearPixels();
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  const auto all_clear = [&](int x0, int y0) {
    for (int y = y0 - kRing; y < y0 + kBlock + kRing; ++y) {
      for (int x = x0 - kRing; x < x0 + kBlock + kRing; ++x) {
        if (!clear[index(x, y)]) return false;
      }
    }
    return true;
  };
  std::vector<ProjectorObservation> observations;
  for (int y0 = kRing; y0 + kBlock + kRing <= height; y0 += kBlock) {
    for (int x0 = kRing; x0 + kBlock + kRing <= width; x0 += kBlock) {
      if (!all_clear(x0, y0)) continue;
      SquareFit across;
      SquareFit down;
      for (int y = 0; y < kBlock; ++y) {
        for (int x = 0; x < kBlock; ++x) {
          const optics::Pixel pixel = *projectorPixel(index(x0 + x, y0 + y));
          across.add(x, y, pixel.x);
          down.add(x, y, pixel.y);
        }
      }
      const auto place = placeOf({x0 + (kBlock - 1) / 2.0, y0 + (kBlock - 1) / 2.0});
      if (!place) continue;
      ProjectorObservation observation;
      observation.place = *place;
      observation.pixel = {across.middle(), down.middle()};
      observation.sigma =
          std::max(kLeastSigma, std::sqrt((across.variance() + down.variance()) / 2));
      observations.push_back(observation);
    }
  }
  return observations;
}

PatternCount PatternReader::count() const {
  PatternCount count;
  const double frames = std::max(1, pictures_.front());
  for (std::size_t at = 0; at < in_arena_.size(); ++at) {
    if (!in_arena_[at]) continue;
    ++count.pixels;
    if (saturated_[at]) {
      ++count.saturated;
    } else if (static_cast<double>(bright_[at] - dark_[at]) / frames < kLeastContrast) {
      ++count.dark;
    } else if (!projectorPixel(at)) {
      ++count.unclear;
    }
  }
  return count;
}

}  // namespace lab::calibration
