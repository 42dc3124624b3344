/// The main() of every service: parse, construct, run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "common/camera/cameras.hpp"
#include "common/experiment/experiment.hpp"
#include "common/loop/descriptor_watcher.hpp"
#include "common/loop/loop.hpp"
#include "common/serial/serial.hpp"
#include "common/service/node.hpp"

namespace CLI {
class App;
}

namespace lab {

/// A component at work. It subscribes and sets its timers in its constructor.
class Service {
 public:
  Service() = default;
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;
  virtual ~Service() = default;

  /// Asked again and again, for a moment, after the node has said its last: whether the service has
  /// still to pass that on.
  [[nodiscard]] virtual bool isForwarding() { return false; }
};

/// What a service is given from outside.
struct ServiceContext {
  Node& node;
  Loop& loop;
  const Experiment& experiment;
  std::filesystem::path directory;  ///< of the experiment file: images lie beside it
  SerialPorts& ports = noSerialPorts();
  std::filesystem::path programs = {};  ///< folder of the lab's executables
  Cameras& cameras = noCameras();
  DescriptorWatcher& descriptors = noDescriptorWatcher();
};

using ServiceFactory = std::function<std::unique_ptr<Service>(const ServiceContext&)>;

struct ServiceDescription {
  std::string name;
  std::string summary;           ///< one line, for --help
  std::int8_t origin = 0;        ///< robot_state_t's
  bool needs_experiment = true;  ///< false: --experiment may be left out
  ServiceFactory make;
  std::function<void(CLI::App&)> add_options{};  ///< what its command line has beyond the others'
  bool uses_ports = false;                       ///< its command line has --ports
};

/// Parses --experiment and --lcm-url, joins the bus, runs the service until SIGINT or SIGTERM, and
/// ends it with its final counts.
/// @return 0 after a clean stop, 2 for bad input or an unusable network, 1 for anything else.
int serviceMain(int argc, char** argv, const ServiceDescription& description);

}  // namespace lab
