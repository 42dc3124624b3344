#include "light/photometry/tone_pictures.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace lab::calibration {
namespace {

constexpr double kApart = 0.10;   // [m]
constexpr double kRadius = 0.02;  // [m] radius of a patch
constexpr int kFewestPixels = 9;
constexpr std::uint8_t kFullScale = 254;
constexpr std::size_t kFewestLights = 4;
constexpr int kFewestPlaces = 12;
constexpr double kLeastSignal = 10;  // [DN] between the darkest and the brightest light
constexpr double kLowest = 0.2;      // smallest gamma
constexpr double kHighest = 6;

double meanOf(const optics::GreyView& grey, int x0, int y0, int x1, int y1, bool& saturated) {
  std::int64_t sum = 0;
  for (int y = y0; y < y1; ++y) {
    const std::uint8_t* row = grey.row(y);
    for (int x = x0; x < x1; ++x) {
      sum += row[x];
      saturated = saturated || row[x] >= kFullScale;
    }
  }
  return static_cast<double>(sum) / ((x1 - x0) * (y1 - y0));
}

struct Line {
  double slope = 0;
  double squares = 0;  ///< sum of squared residuals
};

Line lineThrough(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n;
  const double my = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i] - my);
    yy += (y[i] - my) * (y[i] - my);
  }
  return {xy / xx, std::max(0.0, yy - xy * xy / xx)};
}

std::vector<double> raised(const std::vector<double>& values, double gamma) {
  std::vector<double> out;
  for (const double value : values) out.push_back(value > 0 ? std::pow(value, gamma) : 0);
  return out;
}

double squaresAt(double gamma, const std::vector<double>& values,
                 const std::vector<const ToneObservation*>& observations) {
  const std::vector<double> light = raised(values, gamma);
  double sum = 0;
  for (const ToneObservation* observation : observations)
    sum += lineThrough(light, observation->grey).squares;
  return sum;
}

/// Minimises the sum of squares by golden-section search in log gamma; it has one minimum.
double bestGamma(const std::vector<double>& values,
                 const std::vector<const ToneObservation*>& observations) {
  constexpr int kSteps = 60;
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  double low = std::log(kLowest);
  double high = std::log(kHighest);
  const auto at = [&](double log_gamma) {
    return squaresAt(std::exp(log_gamma), values, observations);
  };
  double left = high - ratio * (high - low);
  double right = low + ratio * (high - low);
  double at_left = at(left);
  double at_right = at(right);
  for (int i = 0; i < kSteps; ++i) {
    if (at_left < at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - ratio * (high - low);
      at_left = at(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + ratio * (high - low);
      at_right = at(right);
    }
  }
  return std::exp((low + high) / 2);
}

/// Compares the fitted white of the places with the known vignetting.
void compareWhite(const std::vector<double>& values,
                  const std::vector<const ToneObservation*>& observations,
                  const optics::ProjectorTone& known, double width, double height,
                  ToneFromPictures& fit) {
  const std::vector<double> light = raised(values, fit.gamma);
  const auto count = static_cast<Eigen::Index>(observations.size());
  Eigen::MatrixXd falloff(count, 6);
  Eigen::VectorXd excess(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ToneObservation& observation = *observations[static_cast<std::size_t>(i)];
    const double a = 2 * observation.place.x / width - 1;
    const double b = 2 * observation.place.y / height - 1;
    falloff.row(i) << 1, a, b, a * a, a * b, b * b;
    excess[i] =
        std::log(lineThrough(light, observation.grey).slope / known.white(observation.place));
  }
  const Eigen::VectorXd left = excess - falloff * falloff.colPivHouseholderQr().solve(excess);
  Eigen::Index worst = 0;
  left.cwiseAbs().maxCoeff(&worst);
  fit.white_rms = std::sqrt(left.squaredNorm() / static_cast<double>(count));
  fit.white_worst = left[worst];
  fit.worst_place = observations[static_cast<std::size_t>(worst)]->place;
}

}  // namespace

TonePictures::TonePictures(const optics::CameraParameters& camera, double width, double height,
                           double surface, std::size_t lights)
    : pictures_(lights) {
  const optics::CameraModel model(camera);
  for (double y = kApart / 2; y < height; y += kApart) {
    for (double x = kApart / 2; x < width; x += kApart) {
      optics::PlaneScale scale;
      const optics::Pixel middle = model.project(x, y, surface, scale);
      const double per_metre = std::sqrt(std::abs(scale.ux * scale.vy - scale.uy * scale.vx));
      const double half = kRadius * per_metre;
      Patch patch{{x, y},
                  static_cast<int>(std::lround(middle.x - half)),
                  static_cast<int>(std::lround(middle.y - half)),
                  static_cast<int>(std::lround(middle.x + half)) + 1,
                  static_cast<int>(std::lround(middle.y + half)) + 1,
                  std::vector<double>(lights),
                  false};
      const bool inside =
          patch.x0 >= 0 && patch.y0 >= 0 && patch.x1 <= camera.width && patch.y1 <= camera.height;
      const int pixels = (patch.x1 - patch.x0) * (patch.y1 - patch.y0);
      if (inside && pixels >= kFewestPixels) patches_.push_back(std::move(patch));
    }
  }
}

void TonePictures::add(std::size_t light, const optics::GreyView& grey) {
  ++pictures_.at(light);
  for (Patch& patch : patches_) {
    patch.sum[light] += meanOf(grey, patch.x0, patch.y0, patch.x1, patch.y1, patch.saturated);
  }
}

std::vector<ToneObservation> TonePictures::observations() const {
  std::vector<ToneObservation> out;
  for (const Patch& patch : patches_) {
    ToneObservation observation{patch.place, patch.sum, patch.saturated};
    for (std::size_t i = 0; i < observation.grey.size(); ++i)
      observation.grey[i] /= std::max(1, pictures_[i]);
    out.push_back(std::move(observation));
  }
  return out;
}

ToneFromPictures fitTone(const std::vector<double>& values,
                         const std::vector<ToneObservation>& observations,
                         const optics::ProjectorTone& known, double width, double height) {
  ToneFromPictures fit;
  std::vector<const ToneObservation*> good;
  double brightest = 0;
  double signal = 0;
  for (const ToneObservation& observation : observations) {
    if (observation.saturated) {
      ++fit.saturated;
      continue;
    }
    const auto [low, high] = std::minmax_element(observation.grey.begin(), observation.grey.end());
    brightest = std::max(brightest, *high);
    signal = std::max(signal, *high - *low);
    good.push_back(&observation);
  }
  fit.places = static_cast<int>(good.size());
  if (values.size() < kFewestLights) {
    fit.refusal = fmt::format("{} lights, expected at least {}", values.size(), kFewestLights);
  } else if (fit.places < kFewestPlaces) {
    fit.refusal = fmt::format(
        "{} places of the arena can be used ({} are saturated), expected at least {}: a shorter "
        "camera.exposure_ms, or more of the arena in the picture",
        fit.places, fit.saturated, kFewestPlaces);
  } else if (signal < kLeastSignal) {
    fit.refusal = fmt::format(
        "the brightest light is {:.1f} of 255 above the darkest, expected at least {:g}: a longer "
        "camera.exposure_ms",
        signal, kLeastSignal);
  }
  if (!fit.refusal.empty()) return fit;
  fit.gamma = bestGamma(values, good);
  const auto places = static_cast<double>(fit.places);
  const double squares = squaresAt(fit.gamma, values, good);
  const double data = places * static_cast<double>(values.size());
  const double variance = squares / (data - 2 * places - 1);
  fit.residual = std::sqrt(squares / data) / brightest;
  const double step = 0.01 * fit.gamma;
  const double curvature = (squaresAt(fit.gamma + step, values, good) - 2 * squares +
                            squaresAt(fit.gamma - step, values, good)) /
                           (step * step);
  fit.gamma_sigma = std::sqrt(2 * variance / curvature);
  compareWhite(values, good, known, width, height, fit);
  return fit;
}

}  // namespace lab::calibration
