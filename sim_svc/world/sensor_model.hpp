/// The light and infrared sensors of the simulated robots.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/math/random.hpp"
#include "robot/dynamics/robot_core.hpp"
#include "sim_svc/world/arena.hpp"
#include "sim_svc/world/disk_arena.hpp"
#include "sim_svc/world/ir_scan.hpp"

namespace lab::sim {

struct SensorSettings {
  double radius = 0.0375;      ///< Of every robot [m].
  double ir_range = 0.05;      ///< From the rim [m].
  double light_offset = 0.03;  ///< Distance of the light sensors before and behind the axle [m].
  double light_noise = 0;      ///< Standard deviation of a light reading [counts].
};

/// The gains of one robot's light sensors; 1 is nominal.
struct LightGains {
  double front = 1;
  double back = 1;
};

/// One scan, with and without the other robots in the IR readings.
struct SensorScan {
  dynamics::Sensors all;
  dynamics::Sensors walls_only;
};

/// Sensor readings [counts], 0..1023, computed from the positions of the disks and the light.
class SensorModel {
 public:
  explicit SensorModel(const SensorSettings& settings) : settings_(settings) {}

  /// Sets the light on the arena; nullptr is dark. It must outlive its use here.
  void setLight(const LightSampler* light) { light_ = light; }

  /// The readings of robot i without the random noise.
  [[nodiscard]] dynamics::Sensors measure(const DiskArena& disks, std::size_t i,
                                          const LightGains& gains) const;

  /// Where the light sensors of robot i are: the front one, then the back one.
  [[nodiscard]] std::array<Vec, 2> lightPlaces(const DiskArena& disks, std::size_t i) const;

  /// The intensities at `count` places (x[i], y[i]).
  void lightAt(const double* x, const double* y, std::size_t count, double* out) const;

  /// The readings of robot i.
  /// @param front, back intensities at its light sensors
  /// @param light_noise the robot's stream; used only if the settings have light noise
  [[nodiscard]] SensorScan scan(const DiskArena& disks, std::size_t i, const LightGains& gains,
                                double front, double back, Random& light_noise) const;

 private:
  void senseLight(const LightGains& gains, double front, double back,
                  dynamics::Sensors& sensors) const;
  void senseObstacles(const DiskArena& disks, std::size_t i, SensorScan& scan) const;

  SensorSettings settings_;
  const LightSampler* light_ = nullptr;
};

}  // namespace lab::sim
