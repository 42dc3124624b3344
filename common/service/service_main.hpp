/// The common main() of all services: parses the command line, constructs the service, runs it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/experiment/command_line_sources.hpp"
#include "common/experiment/experiment.hpp"
#include "common/loop/descriptor_watcher.hpp"
#include "common/loop/loop.hpp"
#include "common/serial/serial.hpp"
#include "common/service/node.hpp"

namespace CLI {
class App;
}

namespace lab {

/// A running service. Its constructor subscribes to channels and sets timers.
class Service {
 public:
  Service() = default;
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;
  virtual ~Service() = default;

  /// Whether messages are still to be forwarded to other buses. serviceMain() asks this after the
  /// node has sent its closing messages, and waits for up to 0.5 s.
  [[nodiscard]] virtual bool isForwarding() { return false; }
};

/// What a service gets from outside.
struct ServiceContext {
  Node& node;
  Loop& loop;
  const Experiment& experiment;
  std::filesystem::path directory;  ///< of the experiment file, which image paths are relative to
  SerialPorts& ports = noSerialPorts();
  std::filesystem::path programs = {};  ///< folder of the executables of this software
  Cameras& cameras = noCameras();
  DescriptorWatcher& descriptors = noDescriptorWatcher();
  std::size_t threads =
      0;  ///< for long computations, which do not depend on it; 0: one a processor
};

class AsioLoop;

/// Makes a service's cameras.
/// @param folder identifies the lab, see SharedCameras
using CamerasFactory =
    std::function<std::unique_ptr<Cameras>(AsioLoop& loop, const std::filesystem::path& folder)>;
using ServiceFactory = std::function<std::unique_ptr<Service>(const ServiceContext&)>;

/// How a service is made, and its command line.
struct ServiceDescription {
  std::string name;
  std::string summary;           ///< one line, for --help
  std::int8_t origin = 0;        ///< as in robot_state_t
  bool needs_experiment = true;  ///< false: --experiment may be left out
  /// Executes nothing of the experiment, so it also takes that of an older run, with keys that are
  /// refused today.
  bool shows_only = false;
  ServiceFactory make;
  std::function<void(CLI::App&)> add_options{};  ///< adds its own command line options
  /// What only the command line may name (docs/security.md), for the experiment.
  std::function<CommandLineSources()> sources{};
  bool uses_ports = false;        ///< whether its command line has --ports
  CamerasFactory make_cameras{};  ///< set by main(); empty: the service uses no cameras
};

/// Parses the command line, joins the bus, runs the service until SIGINT or SIGTERM, and publishes
/// its final counts.
/// @return 0 after a clean stop, 2 for bad input or an unusable network, 1 for anything else.
int serviceMain(int argc, char** argv, const ServiceDescription& description);

}  // namespace lab
