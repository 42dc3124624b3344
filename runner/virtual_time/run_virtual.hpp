/// All services and the controller in one process, in virtual time.
#pragma once

#include <functional>

#include "runner/live/procedure.hpp"
#include "runner/live/progress.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {

/// Runs the services of a live run on an in-memory bus, as fast as the machine allows, and writes
/// the log that lcm-logger would have written. The same experiment and seed give the same bytes.
/// @param interrupted asked once per virtual second; true ends the run cleanly
/// @param procedure drives the robots instead of their light table; may be empty
[[nodiscard]] RunOutcome runVirtual(const PreparedRun& run, const ShowProgress& show,
                                    const std::function<bool()>& interrupted,
                                    const ProcedureFactory& procedure = {});

}  // namespace lab::runner
