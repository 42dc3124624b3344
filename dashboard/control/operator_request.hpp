/// Requests of the operator, made with the buttons of the page.
#pragma once

#include <string>
#include <variant>

namespace lab::dashboard {

struct StopRobots {
  std::string reason;
};
/// Lets the robots move again.
struct ReleaseStop {};
struct PauseScript {};
struct ResumeScript {};
/// Adds a remark to the run.
struct MarkRun {
  std::string text;
};
struct EndRun {
  std::string why;
};
/// Shows uniform light in the whole arena in place of the script's light.
struct ShowLight {
  double intensity = 0;  ///< [1] 0..1
  double hold = 0;       ///< [s], 0: until it is released
};
struct ReleaseLight {};
/// Jumps to another time of a log that is being replayed.
struct SeekLog {
  double to = 0;  ///< [s] since its first message
};
/// Sets the speed of a log that is being replayed.
struct SpeedLog {
  double speed = 1;  ///< [1] seconds of the log per second
};

using OperatorRequest = std::variant<StopRobots, ReleaseStop, PauseScript, ResumeScript, MarkRun,
                                     EndRun, ShowLight, ReleaseLight, SeekLog, SpeedLog>;

}  // namespace lab::dashboard
