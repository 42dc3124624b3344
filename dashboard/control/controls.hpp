/// What becomes of wishes: no bus, no clock.
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

#include "common/service/experiment_request.hpp"
#include "common/service/manual_light.hpp"
#include "common/service/stop_coordinator.hpp"
#include "dashboard/control/operator_request.hpp"

namespace lab::dashboard {

/// What is to be published now.
struct DueCommands {
  std::optional<robot_stop_t> stop;
  std::optional<light_command_t> light;
  std::optional<experiment_command_t> experiment;
};

/// Stops and light go out at once and are repeated as the contract says; wishes towards the
/// experiment go out one after the other, each until it is answered. Times are us since 1970.
class Controls {
 public:
  static constexpr std::size_t kMostWaiting = 8;
  static constexpr std::int64_t kLightTimeout_us = 3'000'000;

  /// @param sender, instance of the node that publishes
  Controls(std::string sender, std::int64_t instance)
      : sender_(std::move(sender)), instance_(instance) {}

  /// @return why it is refused, empty: it is taken.
  [[nodiscard]] std::string wish(const OperatorRequest& wish, std::int64_t now);

  void take(const robot_status_t& status, std::int64_t now) { stop_.take(status, now); }
  void take(const robot_stop_t& stop, std::int64_t now);
  void take(const experiment_status_t& status, std::int64_t now);
  void take(const light_status_t& status, std::int64_t now);

  /// Robots that a stop is for, whether they have been heard or not.
  void expect(const std::vector<std::int32_t>& commanded_robots);

  /// Another run begins: what was asked of the last one is not asked of it, but for a stop.
  void forget();

  /// To be asked at least every 50 ms, and after each wish.
  [[nodiscard]] DueCommands due(std::int64_t now);

  /// Of topic `stop`.
  [[nodiscard]] std::string stopJson() const;

  /// Of topic `note`; empty: nothing has been said yet.
  [[nodiscard]] const std::string& noteJson() const { return note_; }

  /// A log is played: its robots do not hear.
  [[nodiscard]] bool replay() const { return replay_; }

 private:
  struct PendingRequest {
    ExperimentRequest request;
    std::string name;
  };

  std::string act(const ShowLight& light, std::int64_t now);
  std::string ask(const char* name, std::int8_t action, double value, const std::string& text,
                  bool of_a_log, std::int64_t now);
  void note(const std::string& wish, const std::string& text, std::int64_t now);
  void watchLight(const char* name, std::int64_t now);
  [[nodiscard]] std::int64_t nextSeq(std::int64_t now);

  std::string sender_;
  std::int64_t instance_;
  StopCoordinator stop_;
  ManualLight light_;
  std::string pending_light_request_;  ///< whose effect is waited for, empty: none
  std::int64_t light_utime_ = 0;
  std::string light_refusal_;
  std::deque<PendingRequest> pending_requests_;
  std::int64_t sent_utime_ = 0;  ///< of the first errand, 0: not yet
  std::int64_t seq_ = 0;
  std::int64_t heard_utime_ = 0;  ///< EXPERIMENT_STATUS
  bool replay_ = false;
  std::string note_;
};

}  // namespace lab::dashboard
