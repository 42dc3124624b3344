/// Light and programs over time, from the status messages.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "light/field/field.hpp"

namespace lab::report {

/// The light between two changes.
struct LightSpan {
  std::int64_t begin_utime = 0;
  std::string label;      ///< of the step of the script
  std::string commander;  ///< empty: the default field
  double low = 0;         ///< [1] darkest place of the arena
  double high = 0;        ///< [1] brightest
  bool uniform = true;
  bool has_image = false;  ///< low and high are the limits of the image, not its content
};

/// Collects LIGHT_STATUS; a new span begins at each change.
class LightTimeline {
 public:
  /// Size of the arena [m].
  LightTimeline(double width, double height) : width_(width), height_(height) {}

  void take(const light_status_t& status);

  [[nodiscard]] const std::vector<LightSpan>& spans() const { return spans_; }
  [[nodiscard]] const std::string& calibration() const { return calibration_; }

 private:
  void measure(LightSpan& span) const;

  double width_;
  double height_;
  light::Field field_;
  std::vector<LightSpan> spans_;
  std::string calibration_;
};

/// A time in which a robot ran one program.
struct ProgramSpan {
  std::int64_t begin_utime = 0;
  std::int64_t end_utime = 0;
  int program = -1;  ///< the caller's key; -1: standing
};

/// Status of one robot over the run.
struct RobotRecord {
  std::int8_t origin = 0;
  std::vector<ProgramSpan> programs;
  std::int64_t states = 0;   ///< reports in the log
  std::int64_t limited = 0;  ///< reports since whose predecessor a speed or a result was limited
  std::int64_t contact_robot = 0;
  std::int64_t contact_wall = 0;
  std::int64_t stopped = 0;
  std::int64_t lease_expired = 0;
  std::int64_t reversals = 0;
  std::int64_t tumbles = 0;
  /// Delays of the virtual senses: from the exposure of the frame to the reception by the robot
  /// [ms].
  std::vector<float> sense_delays_ms;
  int boots = 0;  ///< starts of the robot, or of the service that reports for it
};

/// Collects ROBOT_STATUS.
class RobotTimelines {
 public:
  using KeyOf = std::function<int(const program_id_t&)>;

  explicit RobotTimelines(KeyOf key_of) : key_of_(std::move(key_of)) {}

  void take(const robot_status_t& status);

  [[nodiscard]] std::map<std::int32_t, RobotRecord> records() const;

 private:
  struct Robot {
    RobotRecord record;
    std::int64_t instance = 0;
    std::int64_t last_utime = 0;
    std::int32_t epoch = -1;
    std::int32_t reversal_count = 0;
    std::int32_t tumble_count = 0;
    std::int64_t senses_utime = 0;
  };

  void take(Robot& robot, const robot_state_t& state, std::int64_t instance);
  void extendPrograms(Robot& robot, const robot_state_t& state, bool fresh) const;

  KeyOf key_of_;
  std::map<std::int32_t, Robot> robots_;
};

}  // namespace lab::report
