/// Layers of a step that depend on what the robots do together (CrowdRule).
#pragma once

#include <cstdint>
#include <lab/collective_t.hpp>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "runner/script/crowd_value.hpp"

namespace lab::runner {

/// Holds a number at a target by the intensity u of a layer:
///
///   u = u0 + gain (e + integral of e dt / integral_time),   e = target - number,
///
/// clamped to [lowest, highest]. While u is at a limit, the integral does not grow further beyond
/// it (anti-windup by conditional integration). u0 is the intensity that the file gives.
class PiRule {
 public:
  PiRule(const CrowdRule& rule, double intensity);

  /// @param dt time since the last value [s]; 0: the first one
  /// @return the intensity
  double take(double value, double dt);

  [[nodiscard]] double intensity() const { return intensity_; }

 private:
  CrowdRule rule_;
  double base_;
  double integral_ = 0;  ///< of e dt / integral_time
  double intensity_;
};

/// Applies the crowd rules of a step. Pure: no bus, no clock.
class CrowdLight {
 public:
  CrowdLight(const Experiment& experiment, const std::vector<LayerSpec>& layers);

  /// Whether a layer has a rule.
  [[nodiscard]] bool given() const { return given_; }

  /// @return whether the layers have changed
  bool take(const collective_t& message);

  /// The layers as they are now, without those that are not shown.
  [[nodiscard]] std::vector<LayerSpec> layers() const;

 private:
  struct Entry {
    LayerSpec layer;
    CrowdValue value;
    PiRule pi;
    bool shown = true;
    std::vector<std::int32_t> robots;  ///< of a quorum
  };

  static bool apply(Entry& entry, const collective_t& message);

  std::vector<Entry> entries_;
  bool given_ = false;
};

}  // namespace lab::runner
