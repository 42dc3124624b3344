#include "tracker_svc/calibration/cap_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lab::calibration {
namespace {

// Lengths in [mm].
constexpr double kMilli = 1e3;  // [mm/m]
constexpr double kWide = 210;
constexpr double kTall = 297;
constexpr double kMargin = 10;  // printers cannot print closer to the edge
constexpr double kTickIn = 1.5;
constexpr double kTickOut = 4;
constexpr double kBetween = 2 * kTickOut + 2;
constexpr double kRuler = 100;
constexpr double kFoot = 15;  // space for the ruler and its caption

// Thin and grey: remains of the line on a cap do not disturb the detector.
constexpr const char* kLine = "stroke=\"#999\" stroke-width=\"0.15\" fill=\"none\"";

int fitting(double room, double pitch) {
  return std::max(1, static_cast<int>(std::floor((room + kBetween) / pitch)));
}

/// Drawn with the front up.
std::string capAt(const optics::CapGeometry& cap, double x, double y) {
  std::string svg;
  const auto out = std::back_inserter(svg);
  const double rim = kMilli * cap.cap_radius;
  fmt::format_to(out, "<circle class=\"rim\" cx=\"{:g}\" cy=\"{:g}\" r=\"{:g}\" {}/>\n", x, y, rim,
                 kLine);
  const auto disc = [&](double offset, double radius) {
    fmt::format_to(out, "<circle cx=\"{:g}\" cy=\"{:g}\" r=\"{:g}\"/>\n", x, y - kMilli * offset,
                   kMilli * radius);
  };
  disc(cap.big_offset, cap.big_radius);
  disc(cap.small_offset, cap.small_radius);
  constexpr int kDirections[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  for (const auto& direction : kDirections) {
    const double from = rim - kTickIn;
    // the front's tick is longer
    const double to = rim + (direction[1] == -1 ? kTickOut : kTickOut / 2);
    fmt::format_to(out, "<path d=\"M{:g} {:g}L{:g} {:g}\" {}/>\n", x + direction[0] * from,
                   y + direction[1] * from, x + direction[0] * to, y + direction[1] * to, kLine);
  }
  return svg;
}

}  // namespace

std::string capSheetSvg(const optics::CapGeometry& cap) {
  const double size = 2 * kMilli * cap.cap_radius;
  const double pitch = size + kBetween;
  const int columns = fitting(kWide - 2 * kMargin - 2 * kTickOut, pitch);
  const int rows = fitting(kTall - 2 * kMargin - 2 * kTickOut - kFoot, pitch);
  const double wide = std::max(kWide, size + 2 * (kMargin + kTickOut));
  const double tall = std::max(kTall, size + 2 * (kMargin + kTickOut) + kFoot);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}mm\" height=\"{1:g}mm\" "
      "viewBox=\"0 0 {0:g} {1:g}\">\n<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"white\"/>\n",
      wide, tall);
  const double left = (wide - (columns - 1) * pitch) / 2;
  const double top = kMargin + kTickOut + size / 2;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      svg += capAt(cap, left + column * pitch, top + row * pitch);
    }
  }
  const double foot = tall - kMargin - 2;
  fmt::format_to(
      std::back_inserter(svg),
      "<path d=\"M{0:g} {2:g}v-3M{0:g} {2:g}H{1:g}v-3\" stroke=\"black\" "
      "stroke-width=\"0.2\" fill=\"none\"/>\n"
      "<text x=\"{0:g}\" y=\"{3:g}\" font-family=\"sans-serif\" font-size=\"3.5\">{4:g} mm: "
      "print at 100 %, on matte paper. The longer tick is the front.</text>\n",
      kMargin, kMargin + kRuler, foot, foot - 5, kRuler);
  return svg + "</svg>\n";
}

}  // namespace lab::calibration
