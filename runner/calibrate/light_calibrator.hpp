/// Measures the projector's light with the robots' own sensors.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <vector>

#include "light/photometry/light_fit.hpp"
#include "runner/live/procedure.hpp"

namespace lab::runner {

/// Lets the robots drive about for a few seconds and stand; then shows a staircase of even lights
/// and keeps what their sensors read; and again, so that they read at many places.
class LightCalibrator final : public Service {
 public:
  /// Values of the pixels, 0..1.
  static const std::vector<double>& levels();

  /// [s] that one round takes when nothing is in its way.
  static double roundTime();

  /// @param rounds at different places
  /// @param samples filled
  /// @param tell called after each round
  /// @param done called when all is done
  LightCalibrator(const ServiceContext& context, ExperimentController& controller, int rounds,
                  std::vector<calibration::LightSample>& samples,
                  std::function<void(int round)> tell, std::function<void()> done);

 private:
  enum class Phase { kBoot, kDrive, kStand, kShow, kDone };

  struct Readings {
    int count = 0;
    double sum[2] = {0, 0};  ///< front, back
    double square[2] = {0, 0};
  };
  struct Stand {
    double x = 0, y = 0, theta = 0;
  };

  void take(const tracked_frame_t& frame);
  void take(const light_status_t& status);
  void take(const robot_status_t& status);
  void tick();
  void enter(Phase phase);
  void drive();
  void showLevel();
  void keepLevel();
  void sendLight();

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  ExperimentController& controller_;
  int rounds_;
  std::vector<calibration::LightSample>& samples_;
  std::function<void(int)> tell_;
  std::function<void()> done_;

  Phase phase_ = Phase::kBoot;
  std::int64_t since_ = 0;  ///< utime of the phase's begin
  int round_ = 0;
  std::size_t level_ = 0;
  light_command_t light_{};
  std::int64_t next_light_ = 0;
  std::int64_t shown_ = 0;  ///< utime of the level's first frame, 0: not shown yet
  std::map<std::int32_t, Stand> stands_;
  std::map<std::int32_t, Readings> readings_;
};

}  // namespace lab::runner
