/// Calibrates a projector's gamma and vignetting and the robots' light sensors from a sequence of
/// uniform lights. No input or output.
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

/// Reading of a sensor while all pixels had the same value.
struct LightSample {
  SensorName sensor;
  optics::Place place;  ///< [m] of the sensor
  double value = 0;     ///< [1] of the pixels, 0..1
  double reading = 0;   ///< [1] mean of several readings, 0..1 of the converter's full scale
  double sigma = 0;     ///< [1] standard error of the mean; at least kLeastSigma is used
};

/// Quantisation of the converter, which has 1024 steps.
inline constexpr double kLeastSigma = 0.0003;  ///< [1]

struct LightLimits {
  double residual = 0.02;  ///< [1] rms at most, of full scale
  int levels = 5;          ///< number of different values at least
  int places = 6;          ///< number of places at least 10 cm apart, for the vignetting
  double gain = 5;         ///< of a sensor at most; its inverse at least
  double gamma = 6;        ///< at most, and its inverse at least
};

/// reading = g (ambient + scale V(x, y) value^gamma), g the gain of each sensor, with mean log gain
/// 0.
struct LightFit {
  double gamma = 1;
  double gamma_sigma = 0;
  double scale = 1;    ///< [1] reading of an average sensor in the projector's white, V = 1
  double ambient = 0;  ///< [1] reading of an average sensor without the projector
  std::array<double, 5> vignetting{};  ///< as in optics::ProjectorTone
  std::map<SensorName, double> gains;
  double residual = 0;  ///< [1] rms, of full scale
  double worst = 0;     ///< [1] largest absolute residual
  int samples = 0;
  int saturated = 0;    ///< number of readings at full scale, excluded
  std::string refusal;  ///< reason why the fit is rejected; empty if accepted

  /// Predicted reading of a sensor.
  [[nodiscard]] double reading(const SensorName& sensor, optics::Place place, double value,
                               double width, double height) const;
};

/// Least squares, weighted by the readings' sigmas.
/// @param width,height of the arena [m]
[[nodiscard]] LightFit fitLight(const std::vector<LightSample>& samples, double width,
                                double height, const LightLimits& limits = {});

}  // namespace lab::calibration
