/// A run as independent processes in real time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/loop/asio_loop.hpp"
#include "runner/live/procedure.hpp"
#include "runner/live/progress.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {

class RemoteHosts;

/// Makes the cameras that a procedure may open. Passed in by the commands that need them, so that
/// `lab run` does not link the camera drivers.
/// @param folder identifies the run, see CameraDevices
using MakeCameras =
    std::function<std::unique_ptr<Cameras>(AsioLoop& loop, const std::filesystem::path& folder)>;

struct LiveOptions {
  std::string name;                   ///< of the lab, as registered
  std::string url;                    ///< of the bus
  std::filesystem::path programs;     ///< folder of the services' programs
  RemoteHosts* hosts = nullptr;       ///< other hosts, connected; nullptr: none
  int port = 0;                       ///< of the bus
  bool web = false;                   ///< starts the dashboard
  std::filesystem::path web_address;  ///< a second file for its address, empty: none
  MakeCameras cameras{};              ///< empty: a procedure has no camera
  /// Prints the head of the run (its folder, its bus). Called once, after the dashboard's address
  /// has been printed; at the latest when the script starts or when the run cannot start.
  std::function<void()> announce{};
  std::int64_t disk_reserve = 50'000'000;  ///< [bytes] the run is closed when less is left
};

/// Starts the recorder, then the services, waits for READY, conducts the experiment, restarts
/// processes that die, and ends the publishers before the recorder.
/// @param procedure drives the robots instead of their light table; may be empty
/// @throws UserError when a service does not get ready; nothing is left running
[[nodiscard]] RunOutcome runLive(const PreparedRun& run, const LiveOptions& options,
                                 const ShowProgress& show, const ProcedureFactory& procedure = {});

}  // namespace lab::runner
