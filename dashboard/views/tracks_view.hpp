/// Positions of the robots during the last minute.
#pragma once

#include <cstdint>
#include <deque>
#include <lab/tracked_frame_t.hpp>
#include <string>
#include <vector>

namespace lab::dashboard {

/// Keeps one position per robot and 0.2 s.
class TracksView {
 public:
  static constexpr std::int64_t kStep_us = 200'000;
  static constexpr std::size_t kSteps = 301;  ///< 60 s
  static constexpr std::size_t kMaxRobots = 500;

  void take(const tracked_frame_t& frame);
  void clear() { steps_.clear(); }

  /// The response to the query `trails`: `{"step_s", "robots": {"ID": [x_cm, y_cm, ...]}}`, the
  /// newest last, null while a robot was not detected. It has at most kMaxRobots robots: those of
  /// the newest steps.
  [[nodiscard]] std::string trailsJson() const;

  /// The response to the query `speeds`: `{"t_s": [], "speed_cm_s": []}`. Each speed is the mean
  /// over one step; t_s is the middle of the step.
  [[nodiscard]] std::string speedsJson(std::int32_t robot) const;

  [[nodiscard]] std::size_t steps() const { return steps_.size(); }

 private:
  struct Place {
    std::int32_t robot = 0;
    float x = 0;  ///< [m]
    float y = 0;  ///< [m]
  };
  struct Step {
    std::int64_t number = 0;
    std::int64_t utime = 0;
    std::vector<Place> places;
  };

  std::deque<Step> steps_;
};

}  // namespace lab::dashboard
