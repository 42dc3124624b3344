#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/math/units.hpp"
#include "common/service/node.hpp"
#include "common/text/printable.hpp"
#include "runner/commands/commands.hpp"
#include "runner/commands/layer_arguments.hpp"
#include "runner/runs/lab_registry.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLightRepeat_us = 100'000;
constexpr std::int64_t kLightTimeout_us = 3'000'000;
// "Until released": the command is not repeated, so it is held until 2100-01-01.
constexpr std::int64_t kUntilReleased_utime = 4'102'444'800'000'000;

std::vector<light::DrivenLayer> layersFor(const RunningLab& lab,
                                          const std::vector<std::string>& texts) {
  const fs::path directory = lab.directory;
  const fs::path file = directory / files::kExperiment;
  if (lab.directory.empty() || !fs::exists(file)) {
    return parseLayers(texts, placeholderExperiment(), {}, fs::current_path());
  }
  const Experiment experiment = loadExperiment(file);
  return parseLayers(texts, experiment, loadImages(experiment, directory).store,
                     fs::current_path());
}

light_command_t command(const LightOptions& options, const RunningLab& lab, std::int64_t now) {
  light_command_t command{};
  command.seq = now;  // differs each time, as a refusal names it
  command.priority = light_command_t::MANUAL;
  command.from_utime = now;
  command.ramp = options.ramp;
  command.release = options.release ? 1 : 0;
  command.hold_until_utime =
      options.hold ? now + units::microseconds(*options.hold) : kUntilReleased_utime;
  command.label = "by hand";
  if (!options.release) setLayers(command, layersFor(lab, options.layers));
  return command;
}

}  // namespace

ExitCode light(const LightOptions& options) {
  if (options.layers.empty() && !options.release) {
    throw UserError(
        "no light given; examples: lab light 0.5, lab light '{kind = \"disk\", x_cm = 60, y_cm = "
        "45, "
        "radius_cm = 20, intensity = 1}', or lab light --release");
  }
  const RunningLab lab = findLab(options.lab);
  AsioLoop loop;
  LcmBus bus(lab.url);
  Node node(bus, loop, {"lab_light", 0, loop.now()});
  light_command_t wanted = command(options, lab, loop.now());
  std::string refusal;
  bool done = false;
  node.subscribe<light_status_t>(channels::kLightStatus, [&](const light_status_t& status) {
    const bool ours = status.commander == node.identity().name;
    const bool shown = ours && status.command_instance == node.identity().instance;
    if (options.release ? !ours && status.utime > wanted.from_utime : shown) done = true;
    refusal = parseRefusal(node.identity().name, wanted.seq, status.last_refusal);
    if (done || !refusal.empty()) loop.stop();
  });
  loop.onReadable(bus.fileDescriptor(), [&] { bus.drain(); });
  const std::int64_t start = loop.now();
  loop.every(kLightRepeat_us, start, [&] {
    if (loop.now() - start > kLightTimeout_us) {
      loop.stop();
      return;
    }
    wanted.utime = 0;
    node.publishCommand(channels::kLightCommand, wanted);
  });
  loop.run();
  node.close();
  if (!done) {
    fmt::print("{}: NOT confirmed: {}\n", lab.name,
               refusal.empty() ? fmt::format("projector_ctl did not report this light within {} s",
                                             kLightTimeout_us / units::kSecond_us)
                               : "refused: " + printable(refusal));
    return kFailed;
  }
  fmt::print("{}: {}\n", lab.name,
             options.release ? "released, the script's light is back" : "shown");
  return kDone;
}

}  // namespace lab::runner
