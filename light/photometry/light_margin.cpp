#include "light/photometry/light_margin.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "light/photometry/projector_tone.hpp"

namespace lab::calibration {
namespace {

/// Probability that a normal error exceeds either edge.
double chanceOutside(double to_low, double to_high, double sigma) {
  const double unit = sigma * std::numbers::sqrt2;
  return 0.5 * (std::erfc(to_low / unit) + std::erfc(to_high / unit));
}

/// Reading of the sensor closest to leaving the band, and its index.
struct WorstReading {
  double reading = 0;
  double inside = std::numeric_limits<double>::infinity();
  SensorName sensor;
};

WorstReading worstAt(const LightFit& fit, const optics::ProjectorTone& tone, const BandLimits& band,
                     double value, const optics::Place& place) {
  WorstReading worst;
  const double light = fit.ambient + fit.scale * tone.light(value, place);
  for (const auto& [sensor, gain] : fit.gains) {
    const double reading = gain * light;
    const double inside = std::min(reading - band.low, band.high - reading);
    if (inside < worst.inside) worst = {reading, inside, sensor};
  }
  return worst;
}

void findWorstPlace(const LightFit& fit, const optics::ProjectorTone& tone, const BandLimits& band,
                    double width, double height, BandMargin& margin) {
  constexpr int kNet = 12;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kNet; ++i) {
    for (int j = 0; j <= kNet; ++j) {
      const optics::Place place{width * i / kNet, height * j / kNet};
      const WorstReading worst = worstAt(fit, tone, band, margin.light, place);
      if (worst.inside >= least) continue;
      least = worst.inside;
      margin.plain_light = worst.reading;
      margin.plain_place = place;
      margin.plain_sensor = worst.sensor;
    }
  }
  margin.plain_right = least > 0;
}

}  // namespace

std::vector<BandMargin> bandMargins(const LightFit& fit, const std::vector<BandLimits>& bands,
                                    double width, double height) {
  const optics::ProjectorTone tone(fit.gamma, fit.vignetting, width, height);
  double least_gain = 1;
  for (const auto& [sensor, gain] : fit.gains) least_gain = std::min(least_gain, gain);
  const double unit = least_gain * fit.scale * tone.weakest();  // [reading] for a light of 1
  const double residual = std::max(fit.residual, kLeastSigma);
  const double sigma = residual / unit;
  std::vector<BandMargin> margins;
  for (const BandLimits& band : bands) {
    BandMargin margin;
    margin.program = band.program;
    margin.light = (band.low + band.high) / 2;
    margin.margin = (band.high - band.low) / 2;
    margin.sigmas = margin.margin / sigma;
    margin.chance = chanceOutside(margin.margin, margin.margin, sigma);
    findWorstPlace(fit, tone, band, width, height, margin);
    for (int row = 0; row < kMarginRows; ++row) {
      for (int column = 0; column < kMarginColumns; ++column) {
        const optics::Place place{width * (column + 0.5) / kMarginColumns,
                                  height * (row + 0.5) / kMarginRows};
        const double reading = worstAt(fit, tone, band, margin.light, place).reading;
        margin.places.push_back(
            {place, reading, chanceOutside(reading - band.low, band.high - reading, residual)});
      }
    }
    margins.push_back(margin);
  }
  return margins;
}

}  // namespace lab::calibration
