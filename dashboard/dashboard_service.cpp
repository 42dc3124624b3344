#include "dashboard/dashboard_service.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/math/units.hpp"
#include "common/process/installation.hpp"
#include "dashboard/web/address_file.hpp"

namespace lab::dashboard {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "dashboard";
constexpr std::int64_t kUpdate_us = 25'000;

/// Loads the images of the light. Without them the layers that need an image are not painted.
light::ImageStore imagesOf(const Experiment& experiment, const fs::path& directory) {
  try {
    return loadImages(experiment, directory).store;
  } catch (const std::exception&) {
    return {};
  }
}

/// The folder of the experiment file, with a trailing slash; empty if no file was given.
fs::path experimentFolder(const ServiceContext& context) {
  return context.experiment.name.empty() ? fs::path() : fs::absolute(context.directory / "");
}

}  // namespace

WebOptions webOptions(const ServiceContext& context, const DashboardOptions& options) {
  const Experiment& experiment = context.experiment;
  WebOptions web;
  web.port = options.port != 0 ? options.port : experiment.dashboard.port;
  web.token = newToken();
  web.runs = options.runs;
  web.programs = context.programs;
  web.experiments = options.experiments.empty() ? installation().experiments : options.experiments;
  if (!options.this_machine_only) {
    if (!experiment.dashboard.address.empty()) web.address = experiment.dashboard.address;
    web.control_from_elsewhere = experiment.dashboard.control_from_elsewhere;
    web.camera_port = experiment.camera.debug_port;
  }
  if (options.address_file.empty()) return web;
  if (const auto before = readAddressFile(options.address_file)) {
    web.port = before->port;
    web.token = before->token;
  }
  return web;
}

DashboardBus::DashboardBus(const ServiceContext& context, Hub& hub, const fs::path& runs,
                           Server server)
    : node_(context.node),
      loop_(context.loop),
      server_(std::move(server)),
      view_(hub, node_.identity().name, node_.identity().instance,
            [own = experimentFolder(context), runs](const Experiment& experiment,
                                                    const std::string& run) {
              if (!own.empty()) return imagesOf(experiment, own);
              return run.empty() ? light::ImageStore{} : imagesOf(experiment, runs / run);
            }) {
  if (const fs::path own = experimentFolder(context); !own.empty()) {
    view_.begin(context.experiment, own.parent_path().filename().string());
  }
  node_.subscribeAll([this](const Packet& packet) { view_.take(packet, loop_.now()); });
  loop_.every(kUpdate_us, loop_.now(), [this] {
    sendDueCommands();
    view_.publishMoving(loop_.now(), server_.viewers() > 0);
  });
  loop_.every(units::kSecond_us, loop_.now() + units::kSecond_us, [this] {
    view_.publishTotals(loop_.now(), server_.facts());
    reportStreamCounts();
  });
}

std::string DashboardBus::request(const OperatorRequest& request) {
  std::string refusal = view_.controls().request(request, loop_.now());
  sendDueCommands();
  return refusal;
}

std::optional<std::string> DashboardBus::query(std::string_view what, std::string_view which) {
  return view_.query(what, which, loop_.now());
}

void DashboardBus::sendDueCommands() {
  DueCommands due = view_.controls().due(loop_.now());
  if (due.stop) node_.publishCommand(channels::kRobotStop, *due.stop);
  if (due.light) {
    due.light->utime = 0;
    node_.publishCommand(channels::kLightCommand, *due.light);
  }
  if (due.experiment) node_.publishCommand(channels::kExperimentCommand, *due.experiment);
}

/// The view counts what this service receives; the heartbeat reports it, as for every service.
void DashboardBus::reportStreamCounts() {
  std::vector<stream_count_t> rows;
  for (const auto& [key, stream] : view_.health().counter().streams()) {
    stream_count_t row{};
    row.channel = key.channel;
    row.sender = key.sender;
    row.instance = key.instance;
    row.received = stream.received;
    row.lost = stream.lost;
    rows.push_back(row);
  }
  for (const auto& [channel, messages] : view_.health().notUnderstood()) {
    stream_count_t row{};
    row.channel = channel;
    row.decode_errors = messages;
    rows.push_back(row);
  }
  node_.reportStreams(std::move(rows));
}

DashboardService::DashboardService(const ServiceContext& context, const DashboardOptions& options)
    : loop_(context.loop),
      host_(ownHost()),
      bus_(context, hub_, options.runs,
           {.viewers = [this] { return viewers(); }, .facts = [this] { return facts(); }}),
      request_queue_(
          {.request = [this](const OperatorRequest& request) { return bus_.request(request); },
           .query = [this](std::string_view what,
                           std::string_view which) { return bus_.query(what, which); }}) {
  watch_ =
      context.descriptors.watch(request_queue_.descriptor(), [this] { request_queue_.serve(); });
  server_ = std::make_unique<WebServer>(webOptions(context, options), hub_, request_queue_);
  if (!options.address_file.empty()) writeAddressFile(options.address_file, server_->address());
  // With an address file, the log does not get the token: logs of runs are passed on.
  const std::string address = server_->address();
  spdlog::info("the page: {}",
               options.address_file.empty() ? address : address.substr(0, address.find('#')));
  context.loop.soon([&node = context.node] { node.ready(); });
}

DashboardService::~DashboardService() {
  // First release the server's threads that wait for the loop, then those that wait for the hub.
  request_queue_.close();
  hub_.close();
  server_.reset();
  watch_.reset();
}

int DashboardService::viewers() const { return server_ ? server_->viewers() : 0; }

ServerFacts DashboardService::facts() {
  ServerFacts facts;
  facts.host = host_;
  facts.pid = getpid();
  facts.viewers = viewers();
  if (server_) facts.refusals = server_->refusals();
  facts.uses = meter_.measure(bus_.pids(host_), loop_.now());
  return facts;
}

ServiceDescription serviceDescription() {
  ServiceDescription description;
  description.name = kName;
  description.summary = "The lab in a browser: arena, light, curves, health, stop";
  description.needs_experiment = false;
  description.shows_only = true;
  const auto options = std::make_shared<DashboardOptions>();
  description.add_options = [options](CLI::App& app) {
    app.add_option("--port", options->port, "First port to try, 0: as in the experiment file")
        ->check(CLI::Range(0, 65535));
    app.add_option("--runs", options->runs, "Folder of past runs")->capture_default_str();
    app.add_option("--experiments", options->experiments, "Folder of the shipped experiments");
    app.add_option(
        "--address-file", options->address_file,
        "File for the page's address; port and token of an existing file are used again");
    app.add_flag("--this-machine-only", options->this_machine_only,
                 "Serve this machine only, whatever the experiment file says");
  };
  description.make = [options](const ServiceContext& context) -> std::unique_ptr<Service> {
    return std::make_unique<DashboardService>(context, *options);
  };
  return description;
}

}  // namespace lab::dashboard
