#include "tracker_svc/overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "light/optics/canvas.hpp"

namespace lab::tracker {
namespace {

using optics::Pixel;

constexpr optics::Colour kGood{60, 235, 90};
constexpr optics::Colour kEdge{90, 190, 255};
constexpr optics::Colour kDegraded{255, 165, 0};
constexpr optics::Colour kUndetected{170, 170, 170};
constexpr optics::Colour kRefused{255, 70, 70};
constexpr optics::Colour kCaption{255, 255, 255};

constexpr float kDegradedBelow = 0.5F;  // quality below which a pose is degraded, see Detection
constexpr double kCm = 100;
constexpr int kCrossArm = 3;  // [px]
constexpr double kOnePixel = 1;
constexpr double kFarOutside = 1e6;  // [px]

constexpr std::array kFitFaults{"none",     "at the border", "low contrast",
                                "not dark", "not round",     "diverged"};

struct Box {
  int x, y, width, height;

  [[nodiscard]] bool meets(const Box& other) const {
    return x < other.x + other.width && other.x < x + width && y < other.y + other.height &&
           other.y < y + height;
  }
};

Box boxOf(int x, int y, std::string_view text) {
  return {x - 1, y - 1, static_cast<int>(text.size()) * optics::kGlyphWidth + 1,
          optics::kGlyphHeight};
}

/// The power of two that makes a dark picture bright enough. Powers of two change rarely, so the
/// picture does not flicker.
int gainFor(const optics::GreyView& picture) {
  constexpr int kStep = 7;  // every seventh pixel is sampled
  constexpr int kBright = 250;
  constexpr int kMost = 16;
  constexpr double kBrightest = 0.02;  // share of the pixels that may saturate
  std::array<int, 256> histogram{};
  int count = 0;
  for (int y = 0; y < picture.height; y += kStep) {
    const std::uint8_t* row = picture.row(y);
    for (int x = 0; x < picture.width; x += kStep, ++count) ++histogram[row[x]];
  }
  std::size_t value = 255;
  int above = histogram[value];
  while (value > 0 && above < kBrightest * count) above += histogram[--value];
  int gain = 1;
  while (gain < kMost && 2 * gain * static_cast<int>(value) <= kBright) gain *= 2;
  return gain;
}

optics::RgbImage coloured(const optics::GreyView& picture, int gain) {
  optics::RgbImage image(picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* grey = picture.row(y);
    std::uint8_t* pixel = image.at(0, y);
    for (int x = 0; x < picture.width; ++x, pixel += 3) {
      pixel[0] = pixel[1] = pixel[2] = static_cast<std::uint8_t>(std::min(255, grey[x] * gain));
    }
  }
  return image;
}

/// Scales the picture to `width`; each new pixel is the mean of those it covers.
optics::RgbImage shrunk(const optics::GreyView& picture, int width, int gain) {
  if (width == picture.width) return coloured(picture, gain);
  const double step = static_cast<double>(picture.width) / width;
  optics::RgbImage image(width, std::max(1, static_cast<int>(std::lround(picture.height / step))));
  const auto edge = [](int i, double pitch, int size) {
    return std::min(size - 1, static_cast<int>(i * pitch));
  };
  for (int y = 0; y < image.height; ++y) {
    const int top = edge(y, step, picture.height);
    const int bottom =
        std::max(top + 1, std::min(picture.height, static_cast<int>((y + 1) * step)));
    for (int x = 0; x < width; ++x) {
      const int left = edge(x, step, picture.width);
      const int right =
          std::max(left + 1, std::min(picture.width, static_cast<int>((x + 1) * step)));
      int sum = 0;
      for (int row = top; row < bottom; ++row) {
        for (int column = left; column < right; ++column) sum += picture.row(row)[column];
      }
      const int mean = sum / ((bottom - top) * (right - left));
      std::fill_n(image.at(x, y), 3, static_cast<std::uint8_t>(std::min(255, mean * gain)));
    }
  }
  return image;
}

class Drawing {
 public:
  Drawing(const OverlayInput& input, const optics::CameraModel& camera,
          const optics::CapGeometry& cap)
      : input_(input), camera_(camera), cap_(cap) {
    const int full = input.picture.width;
    const int width = input.width > 0 ? std::min(input.width, full) : full;
    gain_ = gainFor(input.picture);
    image_ = shrunk(input.picture, width, gain_);
    scale_ = static_cast<double>(width) / full;
  }

  optics::RgbImage draw() {
    caption();
    for (const Mark& mark : input_.marks) outline(mark);
    for (const detector::Rejection& rejection : input_.rejected) cross(rejection);
    // Labels are written before reasons: they get the space first.
    for (const Mark& mark : input_.marks) label(mark);
    for (const Mark& mark : input_.marks) keepFree(mark);
    for (const detector::Rejection& rejection : input_.rejected) reason(rejection);
    legend();
    return std::move(image_);
  }

 private:
  [[nodiscard]] Pixel scaled(Pixel p) const {
    return {(p.x + 0.5) * scale_ - 0.5, (p.y + 0.5) * scale_ - 0.5};
  }

  /// A point on the cap, in the frame of the robot [m].
  [[nodiscard]] Pixel onCap(const detector::Detection& pose, double forward, double left) const {
    const double c = std::cos(pose.theta);
    const double s = std::sin(pose.theta);
    return scaled(camera_.project(pose.x + c * forward - s * left, pose.y + s * forward + c * left,
                                  cap_.height));
  }

  static optics::Colour colourOf(const Mark& mark) {
    if (!mark.detected) return kUndetected;
    if (mark.pose.quality < kDegradedBelow) return kDegraded;
    return (mark.pose.used & detector::kUsedEdge) != 0 ? kEdge : kGood;
  }

  void circle(const detector::Detection& pose, double forward, double radius, optics::Colour colour,
              int corners) {
    Pixel last = onCap(pose, forward + radius, 0);
    for (int i = 1; i <= corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners;
      const Pixel next = onCap(pose, forward + radius * std::cos(angle), radius * std::sin(angle));
      optics::Canvas(image_).line(last, next, colour, kOnePixel);
      last = next;
    }
  }

  void outline(const Mark& mark) {
    const optics::Colour colour = colourOf(mark);
    circle(mark.pose, 0, cap_.cap_radius, colour, 32);
    if (mark.detected) {
      if ((mark.pose.used & detector::kUsedBig) != 0) {
        circle(mark.pose, cap_.big_offset, cap_.big_radius, colour, 16);
      }
      if ((mark.pose.used & detector::kUsedSmall) != 0) {
        circle(mark.pose, cap_.small_offset, cap_.small_radius, colour, 16);
      }
    }
    if (mark.pose.heading == detector::HeadingKind::kUnknown) return;
    const double tip = 1.6 * cap_.cap_radius;
    const double barb = 0.3 * cap_.cap_radius;
    optics::Canvas canvas(image_);
    const Pixel end = onCap(mark.pose, tip, 0);
    canvas.line(onCap(mark.pose, 0, 0), end, colour, 1.5);
    canvas.line(end, onCap(mark.pose, tip - barb, barb), colour, 1.5);
    canvas.line(end, onCap(mark.pose, tip - barb, -barb), colour, 1.5);
  }

  void cross(const detector::Rejection& rejection) {
    const Pixel at = scaled(rejection.where);
    optics::Canvas canvas(image_);
    canvas.line({at.x - kCrossArm, at.y - kCrossArm}, {at.x + kCrossArm, at.y + kCrossArm},
                kRefused, kOnePixel);
    canvas.line({at.x - kCrossArm, at.y + kCrossArm}, {at.x + kCrossArm, at.y - kCrossArm},
                kRefused, kOnePixel);
  }

  /// Writes beside a place unless other text occupies the space.
  bool write(Pixel at, std::string_view text, optics::Colour colour) {
    if (!(std::abs(at.x) + std::abs(at.y) < kFarOutside)) return false;
    const int x = static_cast<int>(std::lround(at.x));
    const int y = static_cast<int>(std::lround(at.y));
    const Box box = boxOf(x, y, text);
    for (const Box& other : written_) {
      if (box.meets(other)) return false;
    }
    written_.push_back(box);
    optics::Canvas canvas(image_);
    canvas.shade(box.x, box.y, box.width, box.height);
    canvas.text(x, y, text, colour);
    return true;
  }

  void label(const Mark& mark) {
    if (mark.label.empty()) return;
    Pixel at = onCap(mark.pose, 0, 0);
    const Pixel rim = onCap(mark.pose, -cap_.cap_radius, 0);
    const double radius = std::hypot(rim.x - at.x, rim.y - at.y);
    const double width = static_cast<double>(mark.label.size()) * optics::kGlyphWidth;
    // Right of the cap, else left of it, else on it.
    const double y = at.y - optics::kGlyphHeight / 2.0;
    if (at.x + radius + 2 + width < image_.width &&
        write({at.x + radius + 2, y}, mark.label, colourOf(mark))) {
      return;
    }
    if (write({at.x - radius - 2 - width, y}, mark.label, colourOf(mark))) return;
    write({at.x - width / 2, y}, mark.label, colourOf(mark));
  }

  /// Reserves the cap's area: no reason is written over it.
  void keepFree(const Mark& mark) {
    const Pixel at = onCap(mark.pose, 0, 0);
    const Pixel rim = onCap(mark.pose, cap_.cap_radius, 0);
    // half the side of a square inside the disc
    const double half = 0.7 * std::hypot(rim.x - at.x, rim.y - at.y);
    if (!(std::abs(at.x) + std::abs(at.y) + half < kFarOutside)) return;
    written_.push_back({static_cast<int>(at.x - half), static_cast<int>(at.y - half),
                        static_cast<int>(2 * half), static_cast<int>(2 * half)});
  }

  void reason(const detector::Rejection& rejection) {
    const Pixel at = scaled(rejection.where);
    const std::string text = rejectionText(rejection);
    const double width = static_cast<double>(text.size()) * optics::kGlyphWidth;
    constexpr double kAway = kCrossArm + 3;
    for (const Pixel place : {Pixel{at.x + kAway, at.y - optics::kGlyphHeight / 2.0},
                              Pixel{at.x - kAway - width, at.y - optics::kGlyphHeight / 2.0},
                              Pixel{at.x - width / 2, at.y + kAway},
                              Pixel{at.x - width / 2, at.y - kAway - optics::kGlyphHeight}}) {
      if (write(place, text, kRefused)) return;
    }
  }

  void caption() {
    std::string text(input_.caption);
    if (gain_ > 1) text += fmt::format("  (shown {} times brighter)", gain_);
    if (text.empty()) return;
    write({4, 4}, text, kCaption);
  }

  /// Writes the number of places per reason in the lower left corner.
  void legend() {
    std::map<std::string_view, std::set<std::pair<double, double>>> places;
    for (const detector::Rejection& rejection : input_.rejected) {
      places[detector::toText(rejection.reason)].emplace(rejection.where.x, rejection.where.y);
    }
    std::string text;
    for (const auto& [reason, there] : places) {
      text += fmt::format("{}{} {}", text.empty() ? "refused: " : ", ", there.size(), reason);
    }
    if (!text.empty()) write({4.0, image_.height - optics::kGlyphHeight - 3.0}, text, kRefused);
  }

  const OverlayInput& input_;
  const optics::CameraModel& camera_;
  const optics::CapGeometry& cap_;
  optics::RgbImage image_;
  std::vector<Box> written_;
  double scale_ = 1;
  int gain_ = 1;
};

}  // namespace

std::vector<Mark> marksOf(std::span<const Track> tracks) {
  std::vector<Mark> marks;
  for (const Track& track : tracks) {
    marks.push_back({track.pose,
                     track.robot_id >= 0 ? fmt::format("R{}", track.robot_id)
                                         : fmt::format("#{}", track.number),
                     track.detected});
  }
  return marks;
}

std::string rejectionText(const detector::Rejection& rejection) {
  const auto value = static_cast<double>(rejection.value);
  const auto limit = static_cast<double>(rejection.limit);
  switch (rejection.reason) {
    case detector::Reason::kCircleFit: {
      const auto fault = static_cast<std::size_t>(std::clamp(value, 0.0, kFitFaults.size() - 1.0));
      return kFitFaults.at(fault);
    }
    case detector::Reason::kSpacing:
      return fmt::format("{} {:.2f}/{:.2f} cm", detector::toText(rejection.reason), value * kCm,
                         limit * kCm);
    case detector::Reason::kNoPartner:
    case detector::Reason::kTaken:
      return std::string(detector::toText(rejection.reason));
    case detector::Reason::kMerged:
      return fmt::format("{} {:.0f}", detector::toText(rejection.reason), value);
    case detector::Reason::kSize:
    case detector::Reason::kNoCap:
    case detector::Reason::kPattern:
      break;
  }
  const double shown = std::abs(value) < 0.005 ? 0 : value;  // avoids "-0.00"
  return fmt::format("{} {:.2f}/{:.2f}", detector::toText(rejection.reason), shown, limit);
}

optics::RgbImage overlay(const OverlayInput& input, const optics::CameraModel& camera,
                         const optics::CapGeometry& cap) {
  if (input.picture.width < 1 || input.picture.height < 1) return {};
  return Drawing(input, camera, cap).draw();
}

}  // namespace lab::tracker
