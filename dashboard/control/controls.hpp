/// Turns requests of the operator into commands. Independent of bus and clock.
#pragma once

#include <cstdint>
#include <deque>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/service/experiment_request.hpp"
#include "common/service/manual_light.hpp"
#include "common/service/stop_coordinator.hpp"
#include "dashboard/control/operator_request.hpp"

namespace lab::dashboard {

/// Commands that are to be published now.
struct DueCommands {
  std::optional<robot_stop_t> stop;
  std::optional<light_command_t> light;
  std::optional<experiment_command_t> experiment;
};

/// Stops and light are sent at once and repeated as lcmtypes/README.md describes. Requests to the
/// experiment are sent one after the other, each until it is answered. Times are us since 1970.
class Controls {
 public:
  static constexpr std::size_t kMaxPending = 8;
  static constexpr std::int64_t kLightTimeout_us = 3'000'000;

  /// @param sender,instance of the node that publishes the commands
  Controls(std::string sender, std::int64_t instance)
      : sender_(std::move(sender)), instance_(instance) {}

  /// @return why the request is refused; empty if it is accepted
  [[nodiscard]] std::string request(const OperatorRequest& request, std::int64_t now);

  void take(const robot_status_t& status, std::int64_t now) { stop_.take(status, now); }
  void take(const robot_stop_t& stop, std::int64_t now);
  void take(const experiment_status_t& status, std::int64_t now);
  void take(const light_status_t& status, std::int64_t now);

  /// The robots that must confirm a stop, including those that have not been heard yet.
  void expect(const std::vector<std::int32_t>& commanded_robots);

  /// Another run begins: drops pending requests to the previous run, but keeps a stop.
  void beginRun();

  /// Call it at least every 50 ms and after each request.
  [[nodiscard]] DueCommands due(std::int64_t now);

  /// JSON of topic `stop`.
  [[nodiscard]] std::string stopJson() const;

  /// JSON of topic `note`, the outcome of the last request; empty before the first one.
  [[nodiscard]] const std::string& noteJson() const { return note_; }

  /// Whether a log is being replayed. Its robots cannot be commanded.
  [[nodiscard]] bool replay() const { return replay_; }

 private:
  struct PendingRequest {
    ExperimentRequest request;
    std::string name;
  };

  std::string showLight(const ShowLight& light, std::int64_t now);
  std::string queue(const char* name, std::int8_t action, double value, const std::string& text,
                    bool needs_log, std::int64_t now);
  void setNote(const std::string& name, const std::string& text, std::int64_t now);
  void waitForLight(const char* name, std::int64_t now);
  [[nodiscard]] std::int64_t nextSeq(std::int64_t now);

  std::string sender_;
  std::int64_t instance_;
  StopCoordinator stop_;
  ManualLight light_;
  std::string pending_light_request_;  ///< name of the request that has no effect yet; or empty
  std::int64_t light_utime_ = 0;
  std::string light_refusal_;
  std::deque<PendingRequest> pending_requests_;
  std::int64_t sent_utime_ = 0;  ///< of the first pending request, 0: not sent yet
  std::int64_t seq_ = 0;
  std::int64_t status_utime_ = 0;  ///< when EXPERIMENT_STATUS was received
  bool replay_ = false;
  std::string note_;
};

}  // namespace lab::dashboard
