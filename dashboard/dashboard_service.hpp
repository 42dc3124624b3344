/// The lab in a browser: listens to the bus, serves the page, carries wishes onto the bus.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "common/service/service_main.hpp"
#include "dashboard/control/request_queue.hpp"
#include "dashboard/health/process_meter.hpp"
#include "dashboard/views/lab_view.hpp"
#include "dashboard/web/hub.hpp"
#include "dashboard/web/web_server.hpp"

namespace lab::dashboard {

/// What the command line says.
struct DashboardOptions {
  int port = 0;  ///< 0: as the experiment says
  std::filesystem::path runs = "runs";
  std::filesystem::path experiments;   ///< empty: as installed
  std::filesystem::path address_file;  ///< empty: none is written
};

/// Between the bus and the hub, without the server: runs in virtual time too.
class DashboardBus {
 public:
  /// What the server says of itself.
  struct Server {
    std::function<int()> viewers;
    std::function<ServerFacts()> facts;
  };

  DashboardBus(const ServiceContext& context, Hub& hub, const std::filesystem::path& runs,
               Server server);

  [[nodiscard]] std::string wish(const OperatorRequest& wish);
  [[nodiscard]] std::optional<std::string> ask(std::string_view what, std::string_view which);

  /// Processes of this lab on this host.
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
  /// @throws std::runtime_error when no port is free
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

/// The service as a process; it does not run in virtual time.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::dashboard
