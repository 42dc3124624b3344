#include "common/service/service_main.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <thread>

#include "common/bus/lcm_bus.hpp"
#include "common/command_line/parse_arguments.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/process/version.hpp"
#include "common/serial/serial_devices.hpp"
#include "common/service/service_log.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string experiment;
  std::string lcm_url = defaultLcmUrl();
  std::string ports = defaultPortsFolder();
  std::optional<std::int64_t> clock_offset_us;
};

constexpr std::int64_t kForwardTimeout_us = 500'000;
constexpr std::int64_t kReportRefused_us = 10'000'000;
constexpr auto kForwardPoll = std::chrono::milliseconds(2);

/// Closes the node. A service that forwards messages then receives the closing messages from the
/// bus, and gets time to forward them.
void end(Node& node, AsioLoop& loop, Service& service) {
  node.close();
  const std::int64_t deadline = loop.now() + kForwardTimeout_us;
  while (service.isForwarding() && loop.now() < deadline) {
    loop.poll();
    std::this_thread::sleep_for(kForwardPoll);
  }
}

Experiment read(const ServiceDescription& description, const std::string& file) {
  if (file.empty()) return {};
  return description.shows_only ? loadRecordedExperiment(file) : loadExperiment(file);
}

void run(const ServiceDescription& description, const Options& options) {
  Experiment experiment = read(description, options.experiment);
  if (description.sources) adopt(description.sources(), experiment);
  AsioLoop loop(options.clock_offset_us);
  LcmBus bus(options.lcm_url);
  SerialDevices ports(loop, options.ports);
  const std::unique_ptr<Cameras> own_cameras =
      description.make_cameras ? description.make_cameras(loop, options.ports) : nullptr;
  Cameras& cameras = own_cameras ? *own_cameras : noCameras();
  Node node(bus, loop, {description.name, description.origin, loop.now()});
  node.reportBus([&bus] { return bus.refused().rows(); });
  const std::unique_ptr<Service> service =
      description.make({node, loop, experiment, fs::path(options.experiment).parent_path(), ports,
                        fs::canonical("/proc/self/exe").parent_path(), cameras, loop});
  loop.onReadable(bus.fileDescriptor(), [&bus] { bus.drain(); });
  loop.onSignals({SIGINT, SIGTERM}, [&loop](int) { loop.stop(); });
  RefusedDatagrams reported;
  const auto report_refused = [&bus, &reported] {
    const RefusedDatagrams refused = bus.refused();
    for (const std::string& line : refused.linesSince(reported)) spdlog::warn("{}", line);
    reported = refused;
  };
  loop.every(kReportRefused_us, loop.now() + kReportRefused_us, report_refused);
  node.start();
  try {
    loop.run();
  } catch (const std::exception& error) {
    node.fault(error.what());
    node.close();
    throw;
  }
  end(node, loop, *service);
  report_refused();
}

}  // namespace

int serviceMain(int argc, char** argv, const ServiceDescription& description) {
  startLog(description.name);
  CLI::App app{description.summary, description.name};
  Options options;
  CLI::Option* experiment =
      app.add_option("--experiment,--config", options.experiment, "Experiment file (TOML)");
  experiment->required(description.needs_experiment);
  app.add_option("--lcm-url", options.lcm_url, "The bus, as printed by lab run")
      ->capture_default_str();
  if (description.uses_ports) {
    app.add_option("--ports", options.ports,
                   "Folder of the lines to simulated robots and of the simulated camera")
        ->capture_default_str();
  }
  app.add_option("--clock-offset-us", options.clock_offset_us,
                 "Wall clock minus steady clock of this machine, so that a service that lab run "
                 "restarts keeps the time of the others");
  if (description.add_options) description.add_options(app);
  app.set_version_flag("--version", kVersion);
  if (const std::optional<int> code = parseArguments(app, argc, argv)) return *code;
  try {
    run(description, options);
    return 0;
  } catch (const ExperimentError& error) {
    spdlog::error("{}", error.what());
    return 2;
  } catch (const BusError& error) {
    spdlog::error("{}", error.what());
    return 2;
  } catch (const SerialError& error) {
    spdlog::error("{}", error.what());
    return 2;
  } catch (const CameraError& error) {
    spdlog::error("{}", error.what());
    return 2;
  } catch (const std::exception& error) {
    spdlog::critical("{}", error.what());
    return 1;
  }
}

}  // namespace lab
