/// The whole lab in one process, in virtual time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "runner/live/experiment_controller.hpp"
#include "runner/live/procedure.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {

/// What came of a run, before its analysis.
struct RunOutcome {
  std::vector<std::string> faults;  ///< empty: nothing broke
  bool closed_early = false;        ///< the disk filled, or a service would not stay up
  bool interrupted = false;         ///< the user ended it
  std::string ended_because;        ///< what the record's END says
};

using ShowProgress = std::function<void(const Progress&)>;

/// Runs the same services as the live lab on an in-memory bus, as fast as the machine allows, and
/// writes the log that lcm-logger would have written: deterministic to the bit.
/// @param interrupted looked at once a virtual second; true ends the run cleanly.
/// @param pilot drives the robots instead of their light table; may be empty.
[[nodiscard]] RunOutcome runVirtual(const PreparedRun& run, const ShowProgress& show,
                                    const std::function<bool()>& interrupted,
                                    const ProcedureFactory& pilot = {});

}  // namespace lab::runner
