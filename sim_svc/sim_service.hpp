/// The simulated robots, arena and camera on the bus.
#pragma once

#include <cstdint>
#include <lab/light_status_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <vector>

#include "common/light_messages.hpp"
#include "common/service_main.hpp"
#include "light/field.hpp"
#include "sim_svc/order_settings.hpp"
#include "sim_svc/tracker_model.hpp"
#include "sim_svc/world.hpp"

namespace lab::sim {

/// Publishes exactly what robot_bridge and tracker_svc would: ROBOT_STATUS and TRACKED_FRAME, and,
/// for tests alone, SIM_TRUTH. The robots see the light that LIGHT_STATUS says is shown.
///
/// The world follows the loop's clock. Cameras and electronics sample it on grids of their own, at
/// their exact times, however late a live timer calls.
class SimService final : public Service {
 public:
  /// @throws std::invalid_argument when the robots cannot be placed.
  explicit SimService(const ServiceContext& context);

 private:
  /// The field shown, as the sensors see it.
  class ShownLight final : public LightSampler {
   public:
    void show(light::CompiledField field) { field_ = std::move(field); }
    [[nodiscard]] double at(double x, double y) const override { return field_.evaluate(x, y); }

   private:
    light::CompiledField field_;
  };

  /// What the service keeps for each robot beside the world.
  struct Link {
    std::int64_t command_seq = 0;
    std::int64_t command_instance = 0;
    std::int64_t stop_seq = 0;
    std::int32_t messages_to = 0;
    std::int32_t messages_from = 0;
    bool rejected = false;
    std::vector<program_t> programs;  ///< by slot
    program_t driven{};               ///< what runs while it is driven by hand
    std::int64_t robot_contacts = 0;  ///< already reported
    std::int64_t wall_contacts = 0;
    std::uint32_t saturations = 0;
  };

  void take(const robot_command_t& command);
  void take(const robot_stop_t& stop);
  void obey(std::size_t i, const robot_order_t& order, const OrderSettings& settings);
  void follow(std::int64_t utime);
  void sampleFrames();
  void sampleRobots();
  void sampleTruth();
  [[nodiscard]] robot_state_t stateOf(std::size_t i);
  [[nodiscard]] std::int64_t utimeOf(double world_seconds) const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  ExperimentImages images_;
  World world_;
  ShownLight light_;
  TrackerModel tracker_;
  std::int64_t origin_utime_;  ///< of world time 0
  std::map<std::int32_t, std::size_t> index_;
  std::vector<Link> links_;
  std::int64_t frame_number_ = 0;
  std::int64_t status_number_ = 0;
  std::int64_t truth_number_ = 0;
  std::int64_t start_utime_;
};

/// The service as a process or as a part of a lab in one process.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::sim
