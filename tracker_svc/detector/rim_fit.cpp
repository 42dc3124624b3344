#include "tracker_svc/detector/rim_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace lab::detector {
namespace {

constexpr std::size_t kSamples = 12;
constexpr double kFirst = -0.0030;  // [m] beyond the rim
constexpr double kStep = 0.0006;    // [m]
constexpr int kRounds = 4;
constexpr double kLeastContrast = 0.06;  // [1] of a direction; bare floor has 0 +- 0.03
constexpr double kFullContrast = 0.3;    // [1]
// [m] sigma: cutting of the caps, calibration of the scale
constexpr double kRadiusError = 0.00015;
constexpr double kModelError = 0.00015;  // [m] per direction
// [m] from the circle, at which a direction is excluded, in the first iteration
constexpr double kFarFirst = 0.0015;
constexpr double kFarLast = 0.0006;    // [m] and in the last
constexpr double kLikeNeighbours = 3;  // neighbouring directions with correlated errors
constexpr double kFloor = 0.00008;     // [m] of the centre, along each axis
constexpr double kMostStep = 0.001;    // [m]

/// Measurement in one direction.
struct Direction {
  double x = 0;  // [1] unit vector to the rim
  double y = 0;
  double off = 0;       // [m] distance of the measured rim outside the circle
  double variance = 0;  // [m^2] of `off`
  double contrast = 0;  // [1]
  bool seen = false;
};

double gauss(double t) { return std::exp(-t * t / 2) * 0.3989422804014327; }
double step(double t) { return std::erfc(-t * std::numbers::sqrt2 / 2) / 2; }

double sampleAt(const optics::GreyView& picture, double x, double y) {
  const int i = static_cast<int>(x);
  const int j = static_cast<int>(y);
  const double a = x - i;
  const double b = y - j;
  const std::uint8_t* upper = picture.row(j);
  const std::uint8_t* lower = picture.row(std::min(j + 1, picture.height - 1));
  const int next = std::min(i + 1, picture.width - 1);
  return (1 - b) * ((1 - a) * upper[i] + a * upper[next]) +
         b * ((1 - a) * lower[i] + a * lower[next]);
}

/// Grey values along a line across the rim.
struct Profile {
  double grey[kSamples];
  double per_metre = 0;  // [px/m]
};

bool readProfile(const optics::GreyView& picture, const optics::CameraModel& camera,
                 const optics::CapGeometry& cap, optics::Place centre, double x, double y,
                 Profile& profile) {
  const double from = cap.cap_radius + kFirst;
  const double to = from + kStep * (kSamples - 1);
  const optics::Pixel a = camera.project(centre.x + from * x, centre.y + from * y, cap.height);
  const optics::Pixel b = camera.project(centre.x + to * x, centre.y + to * y, cap.height);
  if (!picture.contains(a.x, a.y) || !picture.contains(b.x, b.y)) return false;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double share = static_cast<double>(i) / (kSamples - 1);
    profile.grey[i] = sampleAt(picture, a.x + share * (b.x - a.x), a.y + share * (b.y - a.y));
  }
  profile.per_metre = std::hypot(b.x - a.x, b.y - a.y) / (to - from);
  return true;
}

/// Relative reduction of brightness just outside the rim.
double contrastOf(const Profile& profile, const optics::Imaging& imaging) {
  constexpr double kInsideTo = -0.0012;  // [m]
  constexpr double kLineFrom = 0.0002;   // [m]
  constexpr double kLineTo = 0.0016;     // [m]
  double inside = 0;
  double line = 0;
  int insides = 0;
  int lines = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double at = kFirst + kStep * static_cast<double>(i);
    if (at < kInsideTo) {
      inside += profile.grey[i];
      ++insides;
    } else if (at > kLineFrom && at < kLineTo) {
      line += profile.grey[i];
      ++lines;
    }
  }
  inside /= insides;
  line /= lines;
  return (inside - line) / std::max(inside + line + imaging.read_noise - 2 * imaging.black, 1.0);
}

/// Distance of the cap's edge outside the rim, by one linear step from `off` [m], with three free
/// levels.
void measure(const Profile& profile, const optics::CapGeometry& cap, const optics::Imaging& imaging,
             double off, Direction& direction) {
  // Includes the pixel aperture and linear interpolation.
  const double soft =
      std::sqrt(imaging.blur * imaging.blur + optics::kPixelBox + 1.0 / 6) / profile.per_metre;
  const double gap = std::max(cap.robot_radius - cap.cap_radius, 0.0);
  double basis[kSamples][3];
  double slope[kSamples][2];
  double n[3][4] = {};
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double t = (kFirst + kStep * static_cast<double>(i) - off) / soft;
    const double rim = step(t);
    const double end = step(t - gap / soft);
    basis[i][0] = 1 - rim;
    basis[i][1] = rim - end;
    basis[i][2] = end;
    slope[i][0] = gauss(t) / soft;
    slope[i][1] = gauss(t - gap / soft) / soft;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) n[a][b] += basis[i][a] * basis[i][b];
      n[a][3] += basis[i][a] * profile.grey[i];
    }
  }
  for (int a = 0; a < 3; ++a) n[a][a] += 1e-3;  // regularises a level without samples
  // Eliminates the levels from the derivative by `off` in the same step.
  double level[3];
  double m[3][4];
  std::copy(&n[0][0], &n[0][0] + 12, &m[0][0]);
  const auto solve = [](double(&s)[3][4], double(&out)[3]) {
    for (int i = 0; i < 3; ++i) {
      for (int j = i + 1; j < 3; ++j) {
        const double share = s[j][i] / s[i][i];
        for (int k = i; k < 4; ++k) s[j][k] -= share * s[i][k];
      }
    }
    for (int i = 2; i >= 0; --i) {
      out[i] = s[i][3];
      for (int k = i + 1; k < 3; ++k) out[i] -= s[i][k] * out[k];
      out[i] /= s[i][i];
    }
  };
  solve(m, level);
  double outward[kSamples];  // derivative of grey by off
  for (int a = 0; a < 3; ++a) n[a][3] = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    outward[i] =
        level[0] * slope[i][0] - level[1] * (slope[i][0] - slope[i][1]) - level[2] * slope[i][1];
    for (int a = 0; a < 3; ++a) n[a][3] += basis[i][a] * outward[i];
  }
  double same[3];
  solve(n, same);
  double information = 0;
  double product = 0;
  double squares = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    double model = 0;
    for (int a = 0; a < 3; ++a) {
      model += level[a] * basis[i][a];
      outward[i] -= same[a] * basis[i][a];
    }
    const double residual = profile.grey[i] - model;
    information += outward[i] * outward[i];
    product += outward[i] * residual;
    squares += residual * residual;
  }
  const double noise = imaging.read_noise * imaging.read_noise +
                       imaging.shot_gain * std::max(0.0, level[0] - imaging.black) +
                       squares / (kSamples - 4);
  direction.off = off + (information > 0 ? product / information : 0);
  direction.variance = information > 0 ? noise / information + kModelError * kModelError : 1;
}

struct Sums {
  double n[3][3] = {};  // normal matrix of x, y, radius
  double r[3] = {};
  double squares = 0;  // weighted sum
  double used = 0;     // sum of weights
};

/// Inverse of a symmetric positive definite matrix.
void invert(const double (&n)[3][3], double (&out)[3][3]) {
  const double a = n[1][1] * n[2][2] - n[1][2] * n[1][2];
  const double b = n[0][2] * n[1][2] - n[0][1] * n[2][2];
  const double c = n[0][1] * n[1][2] - n[0][2] * n[1][1];
  const double per = 1 / (n[0][0] * a + n[0][1] * b + n[0][2] * c);
  out[0][0] = a * per;
  out[0][1] = out[1][0] = b * per;
  out[0][2] = out[2][0] = c * per;
  out[1][1] = (n[0][0] * n[2][2] - n[0][2] * n[0][2]) * per;
  out[1][2] = out[2][1] = (n[0][1] * n[0][2] - n[0][0] * n[1][2]) * per;
  out[2][2] = (n[0][0] * n[1][1] - n[0][1] * n[0][1]) * per;
}

}  // namespace

float rimAround(const optics::GreyView& picture, const optics::CameraModel& camera,
                const optics::CapGeometry& cap, const optics::Imaging& imaging,
                optics::Place centre) {
  constexpr int kEvery = 2;
  double sum = 0;
  int seen = 0;
  Profile profile;
  for (int k = 0; k < kRimDirections; k += kEvery) {
    const double angle = 2 * std::numbers::pi * k / kRimDirections;
    if (!readProfile(picture, camera, cap, centre, std::cos(angle), std::sin(angle), profile)) {
      continue;
    }
    ++seen;
    sum += std::clamp(contrastOf(profile, imaging), -kLeastContrast, kFullContrast);
  }
  return 3 * kEvery * seen < kRimDirections ? 0 : static_cast<float>(sum / seen);
}

RimFit fitRim(const optics::GreyView& picture, const optics::CameraModel& camera,
              const optics::CapGeometry& cap, const optics::Imaging& imaging, optics::Place start) {
  RimFit fit;
  fit.centre = start;
  double radius = 0;  // [m] excess of the cap's radius
  double inverse[3][3] = {};
  Sums sums;
  for (int round = 0; round < kRounds; ++round) {
    const double far = round + 2 < kRounds ? kFarFirst : kFarLast;
    sums = {};
    sums.n[2][2] = 1 / (kRadiusError * kRadiusError);
    sums.r[2] = -radius * sums.n[2][2];
    fit.visible = 0;
    fit.support = 0;
    Profile profile;
    for (int k = 0; k < kRimDirections; ++k) {
      const double angle = 2 * std::numbers::pi * k / kRimDirections;
      Direction d;
      d.x = std::cos(angle);
      d.y = std::sin(angle);
      if (!readProfile(picture, camera, cap, fit.centre, d.x, d.y, profile)) continue;
      ++fit.visible;
      if (contrastOf(profile, imaging) < kLeastContrast) continue;
      measure(profile, cap, imaging, radius, d);
      const double residual = d.off - radius;
      const double share = 1 - residual * residual / (far * far);
      if (!(share > 0)) continue;
      ++fit.support;
      const double weight = share * share / d.variance;
      const double row[3] = {d.x, d.y, 1};
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) sums.n[a][b] += weight * row[a] * row[b];
        sums.r[a] += weight * row[a] * residual;
      }
      sums.squares += weight * residual * residual;
      sums.used += share * share;
    }
    if (fit.support < 6) return fit;
    invert(sums.n, inverse);
    double move[3] = {};
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) move[a] += inverse[a][b] * sums.r[b];
      move[a] = std::clamp(move[a], -kMostStep, kMostStep);
    }
    fit.centre.x += move[0];
    fit.centre.y += move[1];
    radius += move[2];
  }
  const double scatter = std::max(1.0, sums.squares / std::max(1.0, sums.used - 3));
  const double wider = kLikeNeighbours * scatter;
  fit.covariance = {wider * inverse[0][0] + kFloor * kFloor, wider * inverse[0][1],
                    wider * inverse[1][1] + kFloor * kFloor};
  return fit;
}

}  // namespace lab::detector
