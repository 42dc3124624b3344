/// Which robots of a run misbehaved, by its summary. Pure functions.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace lab::runner::campaign {

enum class RobotProblem {
  kRebooted,  ///< its electronics restarted during the run
  kVanished,  ///< seen for less than half as long as the typical robot
  kStalled,   ///< moves less than half of what robots with its program typically move
};

[[nodiscard]] const char* nameOf(RobotProblem problem);

/// The problems of each robot. A robot has at most one, the first of the above.
///
/// Vanished: the camera saw it in less than half as many frames as the median robot (of one or two
/// robots: in less than half of the frames). Stalled: in the program in which it was seen longest,
/// the root mean square displacement at the lag nearest to 1 s is below half of the median over the
/// robots of this program, of which there must be three. A robot that touched others or walls for a
/// quarter of the time is not called stalled: it may be jammed, which is physics.
/// @param summary_json text of summary.json
/// @param seen share of the frames in which each robot that took part was seen, 0 to 1
/// @throws std::runtime_error if it is none
[[nodiscard]] std::map<std::int32_t, RobotProblem> robotProblems(
    std::string_view summary_json, const std::map<std::int32_t, double>& seen);

}  // namespace lab::runner::campaign
