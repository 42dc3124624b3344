/// A projector's gamma and vignetting and the robots' light sensors from a staircase of even
/// lights. Numbers in, numbers out.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "light/optics/camera_model.hpp"

namespace lab::calibration {

/// One of a robot's two light sensors.
struct SensorName {
  std::int32_t robot = 0;
  bool front = false;

  auto operator<=>(const SensorName&) const = default;
};

/// What a sensor read while every pixel had the same value.
struct LightSample {
  SensorName sensor;
  optics::Place place;  ///< [m] of the sensor
  double value = 0;     ///< [1] of the pixels, 0..1
  double reading = 0;   ///< [1] mean of some readings, 0..1 of the converter's full scale
  double sigma = 0;     ///< [1] standard error of that mean; below kLeastSigma it counts as that
};

/// The converter has 1024 steps.
inline constexpr double kLeastSigma = 0.0003;  ///< [1]

struct LightLimits {
  double residual = 0.02;  ///< [1] rms at most, of full scale
  int levels = 5;          ///< different values at least
  int places = 6;          ///< 10 cm apart at least, for the vignetting
  double gain = 5;         ///< of a sensor at most, and its inverse at least
  double gamma = 6;        ///< at most, and its inverse at least
};

/// reading = g (ambient + scale V(x, y) value^gamma), g of each sensor, their mean logarithm 0.
struct LightFit {
  double gamma = 1;
  double gamma_sigma = 0;
  double scale = 1;    ///< [1] reading of a middling sensor in the projector's white, V = 1
  double ambient = 0;  ///< [1] reading of a middling sensor without the projector
  std::array<double, 5> vignetting{};  ///< of optics::ProjectorTone
  std::map<SensorName, double> gains;
  double residual = 0;  ///< [1] rms, of full scale
  double worst = 0;     ///< [1] largest
  int samples = 0;
  int saturated = 0;    ///< readings at full scale, left out
  std::string refusal;  ///< not empty: why this is no calibration

  /// What a sensor reads there.
  [[nodiscard]] double reading(const SensorName& sensor, optics::Place place, double value,
                               double width, double height) const;
};

/// Levenberg and Marquardt.
/// @param width,height of the arena [m]
[[nodiscard]] LightFit fitLight(const std::vector<LightSample>& samples, double width,
                                double height, const LightLimits& limits = {});

}  // namespace lab::calibration
