/// The simulated robots, arena and camera on the bus.
#pragma once

#include <cstdint>
#include <deque>
#include <lab/light_status_t.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "common/calibration/motor_file.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/service/service_main.hpp"
#include "light/field/field.hpp"
#include "sim_svc/bodies/bus_robots.hpp"
#include "sim_svc/bodies/external_robots.hpp"
#include "sim_svc/bodies/kinematic_robots.hpp"
#include "sim_svc/camera/painted_camera.hpp"
#include "sim_svc/camera/projector_light.hpp"
#include "sim_svc/camera/tracker_model.hpp"
#include "sim_svc/world.hpp"

namespace lab::sim {

/// Publishes exactly what robot_bridge and tracker_svc would: ROBOT_STATUS of the robots that are
/// simulated as a whole and of those replayed, TRACKED_FRAME of all robots it moves, and, for tests
/// alone, SIM_TRUTH. An experiment that tracks with a camera gets pictures of these robots instead
/// of TRACKED_FRAME. Robots on the wire speak through their serial lines. All see the light that
/// LIGHT_STATUS says is shown. What each kind of robot can feel: docs/bodies.md.
///
/// World and robots follow the loop's clock. Cameras and electronics sample it on grids of their
/// own, at their exact times, however late a live timer calls.
class SimService final : public Service {
 public:
  /// @throws std::invalid_argument when the robots cannot be placed.
  /// @throws std::runtime_error when a chip, a line or a recording is not there.
  explicit SimService(const ServiceContext& context);

 private:
  /// The field shown, as the sensors see it.
  class ShownLight final : public LightSampler {
   public:
    ShownLight(const optics::ProjectorWarp& warp, const optics::ProjectorTones& tones)
        : warp_(warp), tones_(tones) {}
    void show(light::CompiledField field) { field_ = std::move(field); }
    [[nodiscard]] double at(double x, double y) const override {
      const std::optional<optics::Place> source =
          warp_.isIdentity() ? optics::Place{x, y} : warp_.source({x, y});
      return source ? tones_.light(field_.evaluate(source->x, source->y), *source, {x, y}) : 0;
    }

   private:
    optics::ProjectorWarp warp_;
    optics::ProjectorTones tones_;
    light::CompiledField field_;
  };

  /// A field whose time has not come: the projector's light takes a while to the arena.
  struct PendingLight {
    std::int64_t utime;
    light::Field field;
  };

  void addExternalRobots(const ServiceContext& context, const MotorCalibrations& motors);
  void subscribe();
  void show(const light_status_t& status);
  void show(light::Field field);
  void follow(std::int64_t utime);
  void advance(std::int64_t utime);
  void moveWorld(std::int64_t utime);
  void sampleFrames(std::int64_t until_utime);
  void trackFrame(std::int64_t exposure);
  void paintFrame(std::int64_t exposure);
  void sampleRobots();
  void sampleTruth();

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  ExperimentImages images_;
  World world_;
  optics::ProjectorWarp warp_;
  ShownLight light_;
  std::deque<PendingLight> pending_light_;  ///< by utime
  TrackerModel tracker_;
  BusRobots bus_robots_;
  ExternalRobots external_robots_;
  std::unique_ptr<PaintedCamera> camera_;  ///< empty: poses are published, not pictures
  std::int64_t start_utime_;               ///< after the camera: to prepare it takes a while
  std::int64_t origin_utime_;              ///< of world time 0
  KinematicRobots kinematic_robots_;
  std::int64_t frame_number_ = 0;
  std::int64_t status_number_ = 0;
  std::int64_t truth_number_ = 0;
};

/// The service as a process or as a part of a lab in one process.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::sim
