#include "sim_svc/sim_service.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <lab/experiment_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <memory>
#include <string>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/math/units.hpp"
#include "common/text/printable.hpp"
#include "light/field/layer.hpp"
#include "sim_svc/bodies/chip_robots.hpp"
#include "sim_svc/bodies/experiment_setup.hpp"
#include "sim_svc/bodies/wire_robots.hpp"

namespace lab::sim {
namespace {

constexpr double kTruthRate = 10;                  // [1/s]
constexpr std::int64_t kOldestFrame_us = 200'000;  // older frames are skipped in real time
// The largest projector.latency, and a second between the clocks of two hosts.
constexpr std::int64_t kFurthestLight_us = 2'000'000;
// A projector of 500 Hz with the largest latency has announced 500.
constexpr std::size_t kMostPendingLight = 512;

std::int64_t period_us(double rate) { return std::max<std::int64_t>(1, std::llround(1e6 / rate)); }

}  // namespace

// Without a warp, the field is evaluated at all places at once.
void SimService::ShownLight::atPlaces(const double* x, const double* y, std::size_t count,
                                      double* out) const {
  if (!warp_.isIdentity()) {
    LightSampler::atPlaces(x, y, count, out);
    return;
  }
  field_.evaluateAt(x, y, count, out);
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = tones_.light(out[i], {x[i], y[i]}, {x[i], y[i]});
  }
}

namespace {

std::vector<std::unique_ptr<PaintedCamera>> paintedCameras(const ServiceContext& context,
                                                           const optics::ProjectorWarp& warp) {
  std::vector<std::unique_ptr<PaintedCamera>> cameras;
  if (!isPainted(context.experiment.camera)) return cameras;
  const optics::ProjectorTones tones = projectorTonesOf(context.experiment, context.directory);
  for (const Camera& camera : camerasOf(context.experiment)) {
    Experiment experiment = context.experiment;
    experiment.camera = camera;
    cameras.push_back(
        std::make_unique<PaintedCamera>(experiment, context.cameras, context.loop, warp, tones));
  }
  return cameras;
}

}  // namespace

SimService::SimService(const ServiceContext& context)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      images_(loadImages(context.experiment, context.directory)),
      world_(worldSettings(context.experiment), simulatedRobots(context.experiment)),
      warp_(projectorWarpOf(context.experiment, context.directory)),
      light_(warp_, projectorTonesOf(context.experiment, context.directory)),
      tracker_(context.experiment.camera, context.experiment.seed),
      frame_times_(context.experiment.camera, context.directory),
      bus_robots_(world_, robotsWithBody(context.experiment, Body::kSim),
                  context.experiment.hardware.sensor_period),
      external_robots_(world_, context.ports, [this] { follow(loop_.now()); }),
      cameras_(paintedCameras(context, warp_)),
      start_utime_(context.loop.now()),
      // The robots boot before the start, each at its own time.
      origin_utime_(start_utime_ - units::microseconds(world_.settings().boot_spread)),
      kinematic_robots_(world_, context.experiment, context.directory, start_utime_) {
  world_.setLight(&light_);
  world_.setThreads(context.threads > 0 ? context.threads : availableProcessors());
  const MotorCalibrations motors = activeMotors(context.experiment, context.directory);
  bus_robots_.handle(toMessage(motors));
  addExternalRobots(context, motors);
  advance(start_utime_);
  frame_times_.begin(start_utime_);
  subscribe();
  loop_.every(period_us(experiment_.camera.fps), start_utime_, [this] { follow(loop_.now()); });
  loop_.every(period_us(experiment_.hardware.status_rate), start_utime_,
              [this] { sampleRobots(); });
  loop_.every(period_us(kTruthRate), start_utime_, [this] { sampleTruth(); });
  if (!external_robots_.empty()) {
    loop_.every(ExternalRobots::kSlice_us, start_utime_, [this] { follow(loop_.now()); });
  }
  loop_.soon([this] { node_.ready(); });
}

void SimService::addExternalRobots(const ServiceContext& context, const MotorCalibrations& motors) {
  std::vector<WireSetup> wire;
  for (const std::size_t body : robotsWithBody(experiment_, Body::kWire)) {
    wire.push_back(
        {body, experiment_.serial.baud, storedSettings(experiment_, motors, world_.id(body))});
  }
  if (!wire.empty()) external_robots_.add(std::make_unique<WireRobots>(world_, wire));

  std::vector<ChipRobotSetup> chips;
  for (const std::size_t body : robotsWithBody(experiment_, Body::kFirmware)) {
    std::vector<std::uint8_t> eeprom(firmware::kStoreSize);
    firmware::encodeStore(storedSettings(experiment_, motors, world_.id(body)), eeprom.data());
    chips.push_back({body, std::move(eeprom)});
  }
  if (chips.empty()) return;
  external_robots_.add(
      std::make_unique<ChipRobots>(world_, std::move(chips), context.programs,
                                   [this](const std::string& what) { node_.noteError(what); }));
}

void SimService::subscribe() {
  node_.subscribe<robot_command_t>(channels::kRobotCommand, [this](const robot_command_t& command) {
    follow(loop_.now());
    const std::string refusal = bus_robots_.handle(command);
    if (!refusal.empty()) {
      node_.noteError("ROBOT_COMMAND of " + command.sender + ": " + refusal);
    }
  });
  node_.subscribe<robot_stop_t>(channels::kRobotStop, [this](const robot_stop_t& stop) {
    follow(loop_.now());
    bus_robots_.handle(stop);
  });
  node_.subscribe<robot_senses_t>(channels::kRobotSenses, [this](const robot_senses_t& senses) {
    follow(loop_.now());
    bus_robots_.handle(senses, origin_utime_ + world_.timeUs());
  });
  node_.subscribe<robot_calibration_t>(
      channels::kRobotCalibration, [this](const robot_calibration_t& calibration) {
        follow(loop_.now());
        auto held = bus_robots_.handle(calibration);
        if (held) node_.publishCommand(channels::kCalibrationStatus, *held);
      });
  node_.subscribe<light_status_t>(channels::kLightStatus,
                                  [this](const light_status_t& status) { show(status); });
  if (frame_times_.isRecorded()) {
    node_.subscribe<experiment_status_t>(
        channels::kExperimentStatus, [this](const experiment_status_t& status) {
          if (status.phase != experiment_status_t::SCRIPT || frame_times_.inScript()) return;
          frame_times_.beginScript(status.utime - units::microseconds(status.elapsed));
          followFrames();
        });
  }
  if (!kinematic_robots_.anyReal()) return;
  // This also receives the service's own frames, but they contain no real robots.
  node_.subscribe<tracked_frame_t>(channels::kTrackedFrame, [this](const tracked_frame_t& frame) {
    follow(loop_.now());
    kinematic_robots_.update(frame, loop_.now());
  });
}

/// Whether light of this time may still be announced. Reports once that it may not.
bool SimService::mayAnnounce(const light_status_t& status) {
  std::string found;
  if (status.utime > loop_.now() + kFurthestLight_us) {
    found = "is dated more than 2 s ahead; set the clocks";
  } else if (pending_light_.size() >= kMostPendingLight &&
             status.utime > pending_light_.back().utime) {
    found = "follows " + std::to_string(kMostPendingLight) +
            " that are announced; end the programs that do not belong to this lab";
  }
  if (found.empty()) return true;
  if (!std::exchange(light_refused_, true)) {
    node_.noteError("LIGHT_STATUS of " + printable(status.sender) + " " + found +
                    ": such light is ignored");
  }
  return false;
}

void SimService::show(const light_status_t& status) {
  if (!mayAnnounce(status)) return;
  light::Field field = toField(status, images_.store);
  if (light::validate(field.layers) || light::validate(field.previous)) {
    node_.noteError("LIGHT_STATUS of " + status.sender + " cannot be painted: ignored");
    return;
  }
  const std::int64_t now = loop_.now();
  // A restarted projector does not show what it had announced before for later times.
  std::erase_if(pending_light_,
                [&](const PendingLight& other) { return other.utime >= status.utime; });
  if (status.utime > now) {
    pending_light_.push_back({status.utime, std::move(field)});
    return;
  }
  follow(now);
  show(std::move(field));
}

void SimService::show(light::Field field) {
  light_.show(light::CompiledField(field));
  for (const auto& camera : cameras_) camera->show(field);
}

/// Advances the world and exposes all camera frames on the way at their exact times. Otherwise a
/// frame whose timer is late on a busy machine would show a later state.
void SimService::follow(std::int64_t utime) {
  sampleFrames(utime);
  advance(utime);
}

/// Advances the world and switches announced light at its exact time on the way.
void SimService::advance(std::int64_t utime) {
  while (!pending_light_.empty() && pending_light_.front().utime <= utime) {
    moveWorld(pending_light_.front().utime);
    show(std::move(pending_light_.front().field));
    pending_light_.pop_front();
  }
  moveWorld(utime);
}

void SimService::moveWorld(std::int64_t utime) {
  if (utime - origin_utime_ <= world_.timeUs()) return;
  kinematic_robots_.follow(origin_utime_ + world_.timeUs());
  external_robots_.advanceTo(utime - origin_utime_);
}

/// Recorded frames have no period, so that each has a timer.
void SimService::followFrames() {
  follow(loop_.now());
  if (!frame_times_.next()) return;
  loop_.at(*frame_times_.next(), [this] { followFrames(); });
}

void SimService::sampleFrames(std::int64_t until_utime) {
  const std::int64_t now = loop_.now();
  while (frame_times_.next() && *frame_times_.next() <= until_utime) {
    const std::int64_t exposure = *frame_times_.next();
    const auto* missing = frame_times_.missing();
    frame_times_.advance();
    bool seen = true;
    if (missing != nullptr) {
      tracker_.beginRecorded(exposure, *missing);
    } else {
      seen = tracker_.begin(exposure);
    }
    if (!loop_.isVirtual() && now - exposure > kOldestFrame_us) {
      // The machine stalled. A burst of old frames would flood the subscribers.
      ++stalled_frames_;
      last_stalled_frame_ = tracker_.frame().frame;
      continue;
    }
    advance(exposure);
    if (!seen) continue;
    if (!cameras_.empty()) {
      paintFrame(exposure);
    } else {
      trackFrame(exposure);
    }
  }
  noteStall();
}

/// Reports skipped frames, once a heartbeat.
void SimService::noteStall() {
  const std::int64_t now = loop_.now();
  if (stalled_frames_ == 0 || now - stall_noted_utime_ < units::kSecond_us) return;
  node_.noteError("stalled: " + std::to_string(std::exchange(stalled_frames_, 0)) +
                  " camera frames up to number " + std::to_string(last_stalled_frame_) +
                  " were skipped");
  stall_noted_utime_ = now;
}

void SimService::trackFrame(std::int64_t exposure) {
  for (std::size_t i = 0; i < world_.size(); ++i) tracker_.observe(world_.id(i), world_.pose(i));
  kinematic_robots_.addTracked(exposure, tracker_);
  loop_.at(exposure + units::microseconds(experiment_.camera.delay),
           [this, frame = tracker_.frame()]() mutable {
             node_.publish(channels::kTrackedFrame, frame);
           });
}

void SimService::paintFrame(std::int64_t exposure) {
  std::vector<PaintedRobot> robots;
  for (std::size_t i = 0; i < world_.size(); ++i) {
    const dynamics::Pose pose = world_.pose(i);
    const Velocity velocity = world_.velocity(i);
    robots.push_back({pose.x, pose.y, pose.theta, velocity.linear.x, velocity.linear.y,
                      velocity.turn, world_.id(i)});
  }
  kinematic_robots_.addPainted(exposure, experiment_.camera.exposure, robots);
  for (const auto& camera : cameras_) camera->take(tracker_.frame().frame, exposure, robots);
}

void SimService::sampleRobots() {
  if (bus_robots_.empty() && !kinematic_robots_.anyReplayed()) return;
  const std::int64_t now = loop_.now();
  const double rate = experiment_.hardware.status_rate;
  std::int64_t due = sampleUtime(start_utime_, status_number_, rate);
  if (due > now) return;
  // Skip reports that a late timer has missed; the next report contains the full state.
  while (sampleUtime(start_utime_, status_number_ + 1, rate) <= now) {
    due = sampleUtime(start_utime_, ++status_number_, rate);
  }
  ++status_number_;
  follow(due);
  robot_status_t status{};
  status.utime = origin_utime_ + world_.timeUs();
  bus_robots_.report(origin_utime_, status.robots);
  kinematic_robots_.addStates(status.utime, status.robots);
  status.num_robots = static_cast<std::int32_t>(status.robots.size());
  node_.publish(channels::kRobotStatus, status);
}

void SimService::sampleTruth() {
  const std::int64_t now = loop_.now();
  if (sampleUtime(start_utime_, truth_number_, kTruthRate) > now) return;
  truth_number_ = static_cast<std::int64_t>(units::seconds(now - start_utime_) * kTruthRate) + 1;
  follow(now);
  sim_truth_t truth{};
  truth.utime = origin_utime_ + world_.timeUs();
  truth.collisions = world_.collisions();
  for (std::size_t i = 0; i < world_.size(); ++i) {
    const RobotState state = world_.state(i);
    true_pose_t pose{};
    pose.robot_id = state.id;
    pose.x = state.pose.x;
    pose.y = state.pose.y;
    pose.theta = state.pose.theta;
    pose.program = state.external ? external_robots_.program(i) : std::int64_t{state.core.program};
    pose.contact_robot = state.contact_robot ? 1 : 0;
    pose.contact_wall = state.contact_wall ? 1 : 0;
    truth.robots.push_back(pose);
  }
  kinematic_robots_.addTruth(truth.utime, truth.robots);
  truth.num_robots = static_cast<std::int32_t>(truth.robots.size());
  node_.publish(channels::kSimTruth, truth);
}

ServiceDescription serviceDescription() {
  const auto threads = std::make_shared<std::size_t>(0);
  return {.name = "sim_svc",
          .summary = "Simulated robots, arena and camera",
          .origin = robot_state_t::SIM,
          .make = [threads](const ServiceContext& context) -> std::unique_ptr<Service> {
            ServiceContext own = context;
            if (*threads > 0) own.threads = *threads;
            return std::make_unique<SimService>(own);
          },
          .add_options =
              [threads](CLI::App& app) {
                app.add_option("--threads", *threads,
                               "Threads that simulate robots (default: one per processor)")
                    ->check(CLI::Range(1, 1024));
              },
          .uses_ports = usesPorts("sim_svc")};
}

}  // namespace lab::sim
