/// Measures the projector's light with the light sensors of the robots.
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

/// In every round, lets the robots drive for a few seconds and stop; then shows a staircase of
/// uniform lights and records the readings of their sensors. Several rounds give readings at many
/// places.
class LightCalibrator final : public Service {
 public:
  /// Pixel values of the staircase, 0..1.
  static const std::vector<double>& levels();

  /// Usual duration of a round [s].
  static double roundTime();

  /// @param rounds number of rounds
  /// @param samples output
  /// @param tell called after each round
  /// @param done called at the end
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
  std::int64_t since_ = 0;  ///< utime of the beginning of the phase
  int round_ = 0;
  std::size_t level_ = 0;
  light_command_t light_{};
  std::int64_t next_light_ = 0;
  std::int64_t shown_ = 0;  ///< utime of the first frame with the level; 0 if not shown yet
  std::map<std::int32_t, Stand> stands_;
  std::map<std::int32_t, Readings> readings_;
};

}  // namespace lab::runner
