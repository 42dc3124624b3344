/// The lab in a browser: receives all messages of the bus, serves the page and publishes the
/// operator's commands.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/service/service_main.hpp"
#include "dashboard/control/request_queue.hpp"
#include "dashboard/health/process_meter.hpp"
#include "dashboard/views/lab_view.hpp"
#include "dashboard/web/hub.hpp"
#include "dashboard/web/web_server.hpp"

namespace lab::dashboard {

/// Options of the command line.
struct DashboardOptions {
  int port = 0;  ///< 0: as in the experiment file
  std::filesystem::path runs = "runs";
  std::filesystem::path experiments;   ///< empty: as installed
  std::filesystem::path address_file;  ///< empty: none is written
  /// The experiment file decides nothing about who may use the page, and names no camera picture.
  bool this_machine_only = false;
};

/// What the web server does, by the experiment file and the command line, with a new token or that
/// of the address file.
[[nodiscard]] WebOptions webOptions(const ServiceContext& context, const DashboardOptions& options);

/// The part between bus and hub. It has no web server, so that it also runs in virtual time.
class DashboardBus {
 public:
  /// Functions that ask the web server for its state.
  struct Server {
    std::function<int()> viewers;
    std::function<ServerFacts()> facts;
  };

  DashboardBus(const ServiceContext& context, Hub& hub, const std::filesystem::path& runs,
               Server server);

  // As in LabRequestHandler.
  [[nodiscard]] std::string request(const OperatorRequest& request);
  [[nodiscard]] std::optional<std::string> query(std::string_view what, std::string_view which);

  /// Process ids of the lab's services on a host.
  [[nodiscard]] std::vector<std::int32_t> pids(const std::string& host) const {
    return view_.health().pids(host);
  }

 private:
  void sendDueCommands();
  void reportStreamCounts();

  Node& node_;
  Loop& loop_;
  Server server_;
  LabView view_;
};

class DashboardService final : public Service {
 public:
  /// @throws std::runtime_error if no port is free
  DashboardService(const ServiceContext& context, const DashboardOptions& options);
  ~DashboardService() override;

 private:
  [[nodiscard]] int viewers() const;
  [[nodiscard]] ServerFacts facts();

  Loop& loop_;
  Hub hub_;
  ProcessMeter meter_;
  std::string host_;
  DashboardBus bus_;
  RequestQueue request_queue_;
  std::unique_ptr<DescriptorWatcher::Watch> watch_;
  std::unique_ptr<WebServer> server_;  ///< last: its threads use the others until they have ended
};

/// Describes the service for serviceMain(). It does not run in virtual time.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::dashboard
