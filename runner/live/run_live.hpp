/// The lab as independent processes in real time.
#pragma once

#include "runner/virtual_time/run_virtual.hpp"

namespace lab::runner {

class RemoteHosts;

struct LiveOptions {
  std::string name;                        ///< of the lab, as registered
  std::string url;                         ///< of the bus
  std::filesystem::path programs;          ///< folder of the services' programs
  std::filesystem::path lcm_logger;        ///< stock lcm-logger
  RemoteHosts* hosts = nullptr;            ///< other hosts, met already; nullptr: none
  int port = 0;                            ///< of the bus
  bool web = false;                        ///< with a page in a browser
  std::filesystem::path web_address;       ///< file for its address too, empty: none
  std::int64_t disk_reserve = 50'000'000;  ///< [bytes] a run is closed when less is left
};

/// Starts lcm-logger, then the services, waits for READY, conducts the experiment, restarts what
/// dies, and ends publishers before the logger.
/// @param pilot drives the robots instead of their light table; may be empty.
/// @throws UserError when a service does not get ready; nothing is left running.
[[nodiscard]] RunOutcome runLive(const PreparedRun& run, const LiveOptions& options,
                                 const ShowProgress& show, const ProcedureFactory& pilot = {});

}  // namespace lab::runner
