/// Connects robots on serial lines with the bus.
#pragma once

#include <cstdint>
#include <lab/robot_calibration_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_senses_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <memory>
#include <string>

#include "common/service/service_main.hpp"
#include "robot_bridge/lines/port_manager.hpp"
#include "robot_bridge/protocol/robot_link.hpp"
#include "robot_bridge/protocol/robot_messages.hpp"

namespace lab::bridge {

/// Publishes ROBOT_STATUS and ROBOT_STEPS for the robots with body = serial, wire or firmware, and
/// executes ROBOT_COMMAND, ROBOT_STOP and ROBOT_SENSES for them. Robots that were silent for more
/// than a second are omitted.
class BridgeService final : public Service {
 public:
  explicit BridgeService(const ServiceContext& context);

 private:
  struct Robot {
    Robot(const LinkSettings& settings, std::int8_t the_origin)
        : link(settings), origin(the_origin) {}
    RobotLink link;
    std::int8_t origin;  ///< robot_state_t's
    ReportHistory reported;
    bool silent = false;  ///< already reported
  };

  void handle(const robot_command_t& command);
  void handle(const robot_stop_t& stop);
  void handle(const robot_calibration_t& request);
  void handle(const robot_senses_t& senses);
  void tick();
  void publish();
  void reportLines();
  [[nodiscard]] PortManager::Robots byUid();

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  std::map<std::int32_t, Robot> robots_;
  PortManager port_manager_;
};

/// The service, for a process of its own or as part of a lab in one process.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::bridge
