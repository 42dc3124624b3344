#include "projector_ctl/calibration/projector_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lab::calibration {
namespace {

constexpr double kMilli = 1e3;
constexpr double kCenti = 100;
constexpr double kPixelsPerMetre = 800;
constexpr int kFrame = 20;         // [px] around the arena
constexpr double kLongest = 0.05;  // [m] of an arrow
constexpr double kHead = 0.012;    // [m] of an arrow's head
constexpr std::uint8_t kPaper = 255;
constexpr std::uint8_t kMesh = 215;
constexpr std::uint8_t kInk = 0;

class Drawing {
 public:
  explicit Drawing(const ProjectorPlane& plane)
      : columns_(2 * kFrame + static_cast<int>(std::lround(kPixelsPerMetre * plane.arena_width))),
        rows_(2 * kFrame + static_cast<int>(std::lround(kPixelsPerMetre * plane.arena_height))),
        grey_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kPaper) {}

  /// Coordinates in metres of the arena; `half` is half the line's width in pixels.
  void line(double x0, double y0, double x1, double y1, double half, std::uint8_t ink) {
    const double u0 = kFrame + kPixelsPerMetre * x0;
    const double u1 = kFrame + kPixelsPerMetre * x1;
    const double v0 = rows_ - kFrame - kPixelsPerMetre * y0;
    const double v1 = rows_ - kFrame - kPixelsPerMetre * y1;
    const double length2 = std::max(1e-12, (u1 - u0) * (u1 - u0) + (v1 - v0) * (v1 - v0));
    const auto low = [&](double a, double b) {
      return std::max(0, static_cast<int>(std::floor(std::min(a, b) - half - 1)));
    };
    const auto high = [&](double a, double b, int end) {
      return std::min(end - 1, static_cast<int>(std::ceil(std::max(a, b) + half + 1)));
    };
    for (int v = low(v0, v1); v <= high(v0, v1, rows_); ++v) {
      for (int u = low(u0, u1); u <= high(u0, u1, columns_); ++u) {
        const double along =
            std::clamp(((u - u0) * (u1 - u0) + (v - v0) * (v1 - v0)) / length2, 0.0, 1.0);
        const double off = std::hypot(u - u0 - along * (u1 - u0), v - v0 - along * (v1 - v0));
        const double cover = std::clamp(half + 0.5 - off, 0.0, 1.0);
        std::uint8_t& pixel =
            grey_[static_cast<std::size_t>(v) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(u)];
        pixel = static_cast<std::uint8_t>(std::lround(pixel + cover * (ink - pixel)));
      }
    }
  }

  [[nodiscard]] ResidualPicture finish(double scale) && {
    return {columns_, rows_, scale, std::move(grey_)};
  }

 private:
  int columns_;
  int rows_;
  std::vector<std::uint8_t> grey_;
};

std::string mapText(const ProjectorFit& fit) {
  std::string text =
      "\nresidual, mm: how far light falls from where the fitted lens puts it, mean over "
      "squares (y up, x to the right, cm)\n";
  auto out = std::back_inserter(text);
  const auto columns = static_cast<std::size_t>(fit.columns);
  const std::size_t rows = fit.squares.size() / columns;
  for (std::size_t row = rows; row-- > 0;) {
    fmt::format_to(out, "{:6.0f} ", kCenti * fit.squares[row * columns].y);
    for (std::size_t i = row * columns; i < (row + 1) * columns; ++i) {
      const SquareResidual& square = fit.squares[i];
      if (square.observations == 0) {
        text += "     -";
      } else {
        fmt::format_to(out, "{:6.3f}", kMilli * std::hypot(square.residual_x, square.residual_y));
      }
    }
    text += "\n";
  }
  text += "       ";
  for (std::size_t i = 0; i < columns; ++i) {
    fmt::format_to(out, "{:6.0f}", kCenti * fit.squares[i].x);
  }
  return text + "\n";
}

}  // namespace

std::string projectorReport(const ProjectorFit& fit, const ProjectorPlane& plane) {
  std::string text;
  auto out = std::back_inserter(text);
  const optics::CameraParameters& p = fit.lens;
  fmt::format_to(out, "picture   {} x {} px\n", plane.columns, plane.rows);
  fmt::format_to(out, "lens      k1 {:.4f}, k2 {:.4f}, p1 {:.5f}, p2 {:.5f}\n", p.k1, p.k2, p.p1,
                 p.p2);
  fmt::format_to(out, "positions {} used, {} left out, on {:.0f} % of the arena\n",
                 fit.observations, fit.outlying, 100 * fit.covered);
  if (fit.squares.empty()) return text;
  text += mapText(fit);
  const SquareResidual& worst = fit.squares[fit.worst];
  fmt::format_to(out,
                 "\nresidual  {:.3f} mm (rms), of which {:.3f} mm are random; worst "
                 "square {:.3f} mm, about ({:.0f}, {:.0f}) cm\n",
                 kMilli * fit.residual, kMilli * fit.noise, kMilli * fit.worstResidual(),
                 kCenti * worst.x, kCenti * worst.y);
  fmt::format_to(
      out,
      "light falls where it is wanted to {:.4f} cm (rms over the arena, at {:g} cm height): "
      "lens model {:.4f}, noise {:.4f}, {}\n",
      kCenti * fit.accuracy, kCenti * plane.height, kCenti * fit.misfit, kCenti * fit.statistical,
      fit.camera > 0 ? fmt::format("the camera's own calibration {:.4f}", kCenti * fit.camera)
                     : "the camera's own calibration not counted");
  return text;
}

ResidualPicture residualPicture(const ProjectorFit& fit, const ProjectorPlane& plane) {
  Drawing drawing(plane);
  const double w = plane.arena_width;
  const double h = plane.arena_height;
  const double longest = fit.worstResidual();
  const double scale = longest > 0 ? kLongest / longest : 1;
  for (const SquareResidual& square : fit.squares) {
    const double half_x = w / fit.columns / 2;
    const double half_y = h * fit.columns / static_cast<double>(fit.squares.size()) / 2;
    drawing.line(square.x - half_x, square.y - half_y, square.x + half_x, square.y - half_y, 0.5,
                 kMesh);
    drawing.line(square.x - half_x, square.y - half_y, square.x - half_x, square.y + half_y, 0.5,
                 kMesh);
  }
  drawing.line(0, 0, w, 0, 1, kInk);
  drawing.line(w, 0, w, h, 1, kInk);
  drawing.line(w, h, 0, h, 1, kInk);
  drawing.line(0, h, 0, 0, 1, kInk);
  for (const SquareResidual& square : fit.squares) {
    if (square.observations == 0) continue;
    const double dx = scale * square.residual_x;
    const double dy = scale * square.residual_y;
    const double x = square.x + dx;
    const double y = square.y + dy;
    const double length = std::hypot(dx, dy);
    drawing.line(square.x, square.y, x, y, 0.8, kInk);
    if (!(length > 0)) continue;
    const double head = std::min(kHead, 0.4 * length) / length;
    for (const double side : {0.5, -0.5}) {
      drawing.line(x, y, x - head * (dx - side * dy), y - head * (dy + side * dx), 0.8, kInk);
    }
  }
  return std::move(drawing).finish(scale);
}

}  // namespace lab::calibration
