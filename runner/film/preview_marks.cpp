#include "runner/film/preview_marks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "common/experiment/program_colours.hpp"
#include "light/optics/canvas.hpp"

namespace lab::runner {
namespace {

using optics::Colour;
using optics::kGlyphHeight;
using optics::kGlyphWidth;

constexpr Colour kTextColour{255, 255, 255};
constexpr Colour kAbsentColour{120, 120, 120};
// Robots are white with a black edge, so that colours belong to programs alone.
constexpr Colour kRobotColour{255, 255, 255};
constexpr Colour kShadow{0, 0, 0};
constexpr int kMargin = 3;                // [px]
constexpr int kLetter = kGlyphWidth + 1;  // [px]
constexpr int kLine = kGlyphHeight + 2;   // [px]
constexpr int kSwatch = kGlyphHeight;     // [px]
constexpr int kOutline = 2;               // [px] on each side of an edge between two bands
constexpr std::array<double, 7> kBars{1, 2, 5, 10, 20, 50, 100};  // [cm]

int widthOf(const std::string& text) { return static_cast<int>(text.size()) * kLetter; }

void fill(optics::RgbImage& image, int x, int y, int width, int height, Colour colour) {
  for (int row = std::max(0, y); row < std::min(y + height, image.height); ++row) {
    for (int column = std::max(0, x); column < std::min(x + width, image.width); ++column) {
      std::uint8_t* pixel = image.at(column, row);
      pixel[0] = colour.red;
      pixel[1] = colour.green;
      pixel[2] = colour.blue;
    }
  }
}

}  // namespace

PreviewMarks::PreviewMarks(const Experiment& experiment, int width, int arena_width,
                           bool with_robots)
    : width_(width),
      scale_(arena_width / experiment.arena_width),
      arena_height_(experiment.arena_height),
      radius_(experiment.hardware.diameter / 2),
      bands_(experiment.light_table.bands) {
  for (const LightBand& band : bands_) {
    colours_.push_back(programColour(experiment, band.program));
    legend_.push_back(
        {fmt::format("{} {:.4g}-{:.4g} %", band.program, 100 * band.low, 100 * band.high),
         colours_.back()});
  }
  if (with_robots) legend_.push_back({"robots at their start", kRobotColour});
  int x = kMargin;
  int row = 0;
  for (Entry& entry : legend_) {
    const int wide = kSwatch + kMargin + widthOf(entry.text) + 3 * kMargin;
    if (x > kMargin && x + wide > width_) {
      x = kMargin;
      ++row;
    }
    entry.x = x;
    entry.row = row;
    x += wide;
  }
}

int PreviewMarks::headHeight() const {
  const int lines = legend_.empty() ? 0 : legend_.back().row + 1;
  return kGlyphHeight + 2 * kMargin + (lines == 0 ? 0 : lines * kLine + kMargin);
}

void PreviewMarks::drawHead(optics::RgbImage& image, const std::string& caption,
                            const light::Raster& light) const {
  optics::Canvas(image).text(kMargin, kMargin, caption, kTextColour);
  for (std::size_t i = 0; i < legend_.size(); ++i) {
    const Entry& entry = legend_[i];
    const bool shown = i >= bands_.size() || isSelected(i, light);
    const int y = kGlyphHeight + 2 * kMargin + entry.row * kLine;
    fill(image, entry.x, y, kSwatch, kSwatch, shown ? entry.colour : kAbsentColour);
    optics::Canvas(image).text(entry.x + kSwatch + kMargin, y, entry.text,
                               shown ? kTextColour : kAbsentColour);
  }
}

bool PreviewMarks::isSelected(std::size_t band, const light::Raster& light) const {
  return std::ranges::any_of(light.values, [&each = bands_[band]](float value) {
    return contains(each, static_cast<double>(value));
  });
}

int PreviewMarks::bandAt(double light) const {
  const auto band = std::ranges::find_if(
      bands_, [light](const LightBand& each) { return contains(each, light); });
  return band == bands_.end() ? -1 : static_cast<int>(std::distance(bands_.begin(), band));
}

void PreviewMarks::drawBands(optics::RgbImage& image, const light::Raster& light) const {
  std::vector<int> band(light.values.size());
  std::ranges::transform(light.values, band.begin(),
                         [this](float value) { return bandAt(static_cast<double>(value)); });
  const auto at = [&](int column, int row) {
    return band[static_cast<std::size_t>(row) * static_cast<std::size_t>(light.nx) +
                static_cast<std::size_t>(column)];
  };
  const auto atEdge = [&](int column, int row) {
    for (int y = std::max(0, row - kOutline); y <= std::min(light.ny - 1, row + kOutline); ++y) {
      for (int x = std::max(0, column - kOutline); x <= std::min(light.nx - 1, column + kOutline);
           ++x) {
        if (at(x, y) != at(column, row)) return true;
      }
    }
    return false;
  };
  for (int row = 0; row < light.ny; ++row) {
    for (int column = 0; column < light.nx; ++column) {
      const int own = at(column, row);
      if (own < 0 || !atEdge(column, row)) continue;
      fill(image, column, image.height - 1 - row, 1, 1, colours_[static_cast<std::size_t>(own)]);
    }
  }
}

void PreviewMarks::drawScale(optics::RgbImage& image) const {
  // The longest that takes at most a quarter of the width.
  double length = kBars.front();
  for (const double bar : kBars) {
    if (bar / 100 * scale_ <= width_ / 4.0) length = bar;
  }
  const std::string text = fmt::format("{:g} cm", length);
  const int wide = std::max(1, static_cast<int>(std::lround(length / 100 * scale_)));
  const int high = kGlyphHeight + 3 * kMargin;
  const int y = image.height - high;
  optics::Canvas canvas(image);
  canvas.shade(0, y, std::max(wide, widthOf(text)) + 2 * kMargin, high);
  canvas.text(kMargin, y + kMargin / 2, text, kTextColour);
  const int bar = y + kGlyphHeight + kMargin;
  fill(image, kMargin, bar, wide, 1, kTextColour);
  for (const int end : {kMargin, kMargin + wide - 1}) fill(image, end, bar - 1, 1, 3, kTextColour);
}

void PreviewMarks::drawRobots(optics::RgbImage& image,
                              const projector::ObservedFrame& frame) const {
  constexpr int kSides = 24;
  optics::Canvas canvas(image);
  for (const projector::ObservedRobot& robot : frame.robots) {
    const auto place = [&](double angle, double radius) {
      const double x = robot.x + radius * std::cos(angle);
      const double y = robot.y + radius * std::sin(angle);
      return optics::Pixel{x * scale_, headHeight() + (arena_height_ - y) * scale_};
    };
    const auto outline = [&](Colour colour, double edge) {
      for (int side = 0; side < kSides; ++side) {
        const double step = 2 * std::numbers::pi / kSides;
        canvas.line(place(side * step, radius_), place((side + 1) * step, radius_), colour,
                    1 + edge);
      }
      canvas.line(place(robot.theta, radius_), place(robot.theta, 1.5 * radius_), colour, 2 + edge);
    };
    outline(kShadow, 2);
    outline(kRobotColour, 0);
    const std::string id = std::to_string(robot.id);
    if (widthOf(id) > 2 * radius_ * scale_) continue;
    const optics::Pixel centre = place(0, 0);
    const int x = static_cast<int>(std::lround(centre.x)) - (widthOf(id) - 1) / 2;
    const int y = static_cast<int>(std::lround(centre.y)) - kGlyphHeight / 2;
    canvas.shade(x - 1, y - 1, widthOf(id) + 1, kGlyphHeight + 2);
    canvas.text(x + 1, y + 1, id, kShadow);
    canvas.text(x, y, id, kTextColour);
  }
}

}  // namespace lab::runner
