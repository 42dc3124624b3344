/// Connects the simulated robots, arena and camera with the bus.
#pragma once

#include <cstddef>
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
#include "sim_svc/camera/frame_times.hpp"
#include "sim_svc/camera/painted_camera.hpp"
#include "sim_svc/camera/projector_light.hpp"
#include "sim_svc/camera/tracker_model.hpp"
#include "sim_svc/world.hpp"

namespace lab::sim {

/// Publishes the same messages as robot_bridge and tracker_svc: ROBOT_STATUS of the robots with
/// body sim or replay, TRACKED_FRAME of all robots that it moves, and SIM_TRUTH, which is for tests
/// only. If the experiment tracks with a camera, it produces pictures of these robots instead of
/// TRACKED_FRAME. Robots on the wire use their serial lines. All robots see the light that
/// LIGHT_STATUS reports. docs/bodies.md compares the kinds of robots.
///
/// World and robots follow the loop's clock. Camera and electronics sample the world at exact
/// multiples of their periods, even if a live timer calls late.
class SimService final : public Service {
 public:
  /// @throws std::invalid_argument if the robots cannot be placed.
  /// @throws std::runtime_error if a chip, a line or a recording is missing.
  explicit SimService(const ServiceContext& context);

 private:
  /// The projected light field, for the simulated sensors.
  class ShownLight final : public LightSampler {
   public:
    ShownLight(const optics::ProjectorWarp& warp, const optics::ProjectorTones& tones)
        : warp_(warp), tones_(tones) {}
    void show(light::CompiledField field) { field_ = std::move(field); }
    void atPlaces(const double* x, const double* y, std::size_t count, double* out) const override;
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

  /// A field that is announced for a later time, because the projector has a latency.
  struct PendingLight {
    std::int64_t utime;
    light::Field field;
  };

  void addExternalRobots(const ServiceContext& context, const MotorCalibrations& motors);
  void subscribe();
  [[nodiscard]] bool mayAnnounce(const light_status_t& status);
  void show(const light_status_t& status);
  void show(light::Field field);
  void follow(std::int64_t utime);
  void advance(std::int64_t utime);
  void moveWorld(std::int64_t utime);
  void sampleFrames(std::int64_t until_utime);
  void noteStall();
  void followFrames();
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
  std::deque<PendingLight> pending_light_;  ///< in order of utime
  TrackerModel tracker_;
  FrameTimes frame_times_;
  BusRobots bus_robots_;
  ExternalRobots external_robots_;
  std::vector<std::unique_ptr<PaintedCamera>> cameras_;  ///< none: poses instead of pictures
  std::int64_t start_utime_;   ///< declared after cameras_, whose construction is slow
  std::int64_t origin_utime_;  ///< utime of world time 0
  KinematicRobots kinematic_robots_;
  bool light_refused_ = false;       ///< and reported
  std::int64_t stalled_frames_ = 0;  ///< skipped and not yet reported
  std::int64_t last_stalled_frame_ = 0;
  std::int64_t stall_noted_utime_ = 0;
  std::int64_t status_number_ = 0;
  std::int64_t truth_number_ = 0;
};

/// The service, for a process of its own or as part of a lab in one process.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::sim
