/// What somebody in front of the page asks for.
#pragma once

#include <string>
#include <variant>

namespace lab::dashboard {

struct StopRobots {
  std::string reason;
};
/// Robots may move again.
struct ReleaseStop {};
struct PauseScript {};
struct ResumeScript {};
struct MarkRun {
  std::string text;
};
struct EndRun {
  std::string why;
};
/// One light for the whole arena, above the script's.
struct ShowLight {
  double intensity = 0;  ///< [1] 0..1
  double hold = 0;       ///< [s], 0: until it is given back
};
struct ReleaseLight {};
/// Of a log that is played.
struct SeekLog {
  double to = 0;  ///< [s] since its first message
};
struct SpeedLog {
  double speed = 1;  ///< [1] log seconds a second
};

using OperatorRequest = std::variant<StopRobots, ReleaseStop, PauseScript, ResumeScript, MarkRun,
                                     EndRun, ShowLight, ReleaseLight, SeekLog, SpeedLog>;

}  // namespace lab::dashboard
