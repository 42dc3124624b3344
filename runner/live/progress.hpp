/// The state of a run while it lasts, and how it ended.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace lab::runner {

/// The state of a run, for the progress line.
struct Progress {
  bool begun = false;                         ///< the script has begun
  double elapsed = 0;                         ///< [s] of the script, without pauses
  double left = 0;                            ///< [s] of the script
  bool at_most = false;                       ///< the run may end earlier than `left` says
  bool paused = false;                        ///< the script's clock stands still
  std::size_t robots_stopped = 0;             ///< under a stop that nobody has released
  std::string stop;                           ///< progress of the rules in stop_when
  std::string light;                          ///< label of the step shown
  std::size_t robots_seen = 0;                ///< by the tracker, in the last second
  std::map<std::string, int> robots_running;  ///< number of robots by name of their program
  std::int64_t lost = 0;                      ///< messages that this process missed
};

using ShowProgress = std::function<void(const Progress&)>;

/// Why a run ends.
enum class Ending {
  kDone,       ///< the script ended, or stop_when was reached
  kRequested,  ///< a user ended it
  kUnmet,      ///< a condition of the script, or stop_when, was not met: the run is marked
  kBroken,     ///< a fault that makes it useless to go on
};

/// The result of a run, before its analysis.
struct RunOutcome {
  std::vector<std::string> faults;  ///< empty: no fault
  bool closed_early = false;        ///< the disk filled up, or a service kept dying
  bool interrupted = false;         ///< the user ended it
  std::string ended_because;        ///< the reason in the END event of the record
};

}  // namespace lab::runner
