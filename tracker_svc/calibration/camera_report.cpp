#include "tracker_svc/calibration/camera_report.hpp"

#include <fmt/format.h>

#include <iterator>

namespace lab::calibration {
namespace {

constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;
constexpr double kCenti = 100;

std::string mapText(const ErrorMap& map) {
  std::string text =
      "\nstandard error of positions, mm; in parentheses the error of the caps' spacing "
      "there, um (y up, x to the right, cm)\n";
  auto out = std::back_inserter(text);
  for (int row = ErrorMap::kRows - 1; row >= 0; --row) {
    const auto first = static_cast<std::size_t>(row * ErrorMap::kColumns);
    fmt::format_to(out, "{:6.0f}  ", kCenti * map.places[first].y);
    for (std::size_t i = first; i < first + ErrorMap::kColumns; ++i) {
      const PlaceError& place = map.places[i];
      fmt::format_to(out, "{:6.2f} {:>11}", kMilli * place.frame,
                     place.caps == 0 ? "(no caps)"
                                     : fmt::format("({:+.0f} +- {:.0f})", kMicro * place.spacing,
                                                   kMicro * place.spacing_sigma));
    }
    text += "\n";
  }
  text += "        ";
  for (std::size_t i = 0; i < ErrorMap::kColumns; ++i) {
    fmt::format_to(out, "{:6.0f} {:11}", kCenti * map.places[i].x, "");
  }
  while (text.back() == ' ') text.pop_back();
  return text + "\n";
}

}  // namespace

std::string cameraReport(const CameraFit& fit) {
  std::string text;
  auto out = std::back_inserter(text);
  const optics::CameraParameters& p = fit.camera;
  const optics::CameraParameters& e = fit.error;
  const auto line = [&out](const char* name, double value, double error, int digits) {
    fmt::format_to(out, "{:<10}{:>12.{}f} +- {:.{}f}\n", name, value, digits, error, digits);
  };
  line("fx, px", p.fx, e.fx, 2);
  line("fy, px", p.fy, e.fy, 2);
  line("cx, px", p.cx, e.cx, 2);
  line("cy, px", p.cy, e.cy, 2);
  line("k1", p.k1, e.k1, 5);
  line("k2", p.k2, e.k2, 5);
  line("p1", p.p1, e.p1, 6);
  line("p2", p.p2, e.p2, 6);
  if (p.k3 != 0 && e.k3 > 1e-6) line("k3", p.k3, e.k3, 5);
  line("height, cm", kCenti * fit.height, kCenti * fit.height_error, 2);
  fmt::format_to(out, "corners   residual {:.2f} px (rms)\n", fit.corner_residual);
  if (fit.caps > 0) {
    fmt::format_to(
        out,
        "caps      {} used, {} left out; residual of the spacing {:.3f} mm (rms), circles are "
        "found to {:.3f} px\n",
        fit.caps, fit.outlying, kMilli * fit.spacing_residual, fit.cap_noise);
  }
  if (fit.board_residual > 0) {
    fmt::format_to(out, "board     residual of the discs {:.3f} px (rms)\n", fit.board_residual);
  }
  text += mapText(fit.map);
  fmt::format_to(
      out,
      "\nstandard error of positions {:.2f} mm (rms over the arena, at worst {:.2f}), {:.2f} mm "
      "without a common shift and rotation\n",
      kMilli * fit.map.rms, kMilli * fit.map.largest, kMilli * fit.map.shape);
  return text;
}

}  // namespace lab::calibration
