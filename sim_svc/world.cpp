#include "sim_svc/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "sim_svc/placement.hpp"

namespace lab::sim {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kLargestPhaseMs = 60000;
constexpr double kBatteryFull = 4.15;         // V, of a Li-ion cell
constexpr double kBatterySpread = 0.02;       // V
constexpr double kBatteryFall = 0.15 / 3600;  // V/s
constexpr double kMicro = 1e-6;
constexpr std::size_t kGroup = 256;     // robots that move together, on one thread
constexpr std::size_t kFetchAhead = 6;  // robots
constexpr std::size_t kCacheLine = 64;  // [bytes]

/// Asks the processor for the first bytes of an object. Without it the first access to the next
/// robot took a third of the time of 10 000 robots.
template <class T>
void fetch(const T* object) {
  const char* bytes = reinterpret_cast<const char*>(object);
  for (std::size_t at = 0; at < std::min<std::size_t>(sizeof(T), 8 * kCacheLine);
       at += kCacheLine) {
    __builtin_prefetch(bytes + at);
  }
}

std::vector<dynamics::Pose> place(const WorldSettings& settings,
                                  const std::vector<RobotSetup>& robots) {
  std::vector<Place> places;
  places.reserve(robots.size());
  for (const RobotSetup& robot : robots) {
    places.push_back({robot.id, robot.pose});
  }
  return placeRobots(places, settings.arena, settings.radius, settings.seed);
}

// The farthest that a robot can move by itself in a time [s]: 1.5 is the largest wheel gain, see
// factor(), and displace() keeps the noise within 5 standard deviations.
double largestMove(const WorldSettings& settings, double time) {
  return std::max(1.5 * settings.max_wheel_speed * time,
                  5 * settings.speed_noise * std::sqrt(time));
}

// Robots that push each other overlap during a step. With moves of at most half a radius the sides
// on which they touch are certain.
WorldSettings withShortTicks(WorldSettings settings) {
  if (settings.contact == ContactRule::kStop) return settings;
  const double most = settings.radius / 2;
  while (settings.tick_us > 1 &&
         largestMove(settings, static_cast<double>(settings.tick_us) * 1e-6) > most) {
    settings.tick_us = (settings.tick_us + 1) / 2;
  }
  return settings;
}

DiskArenaSettings diskSettings(const WorldSettings& settings) {
  const double largest_move =
      largestMove(settings, static_cast<double>(settings.tick_us) * 1e-6) + 1e-6;
  return {settings.arena,   settings.radius,           settings.ir_range, largest_move,
          settings.contact, settings.contact_friction, settings.slip};
}

// Limited, because the bounds of the neighbour lists assume a largest speed.
double factor(Random& random, double error) {
  return std::clamp(1 + error * random.normal(), 0.5, 1.5);
}

}  // namespace

World::World(const WorldSettings& settings, const std::vector<RobotSetup>& robots)
    : settings_(withShortTicks(settings)),
      disks_(diskSettings(settings_), place(settings, robots)),
      sensors_({settings.radius, settings.ir_range, settings.light_offset, settings.light_noise}) {
  for (const RobotSetup& robot : robots) {
    addRobot(robot);
  }
}

void World::addRobot(const RobotSetup& setup) {
  const auto stream = [&](const char* purpose) {
    return deriveSeed(settings_.seed, setup.id, purpose);
  };
  Random clock(stream("clock"));
  Random wheels(stream("wheels"));
  Electronics robot(*programs_);
  robot.id = setup.id;
  robot.external = setup.external;
  const auto max_um_s = static_cast<std::int32_t>(std::lround(settings_.max_wheel_speed * 1e6));
  const double dead_band = dynamics::kMaxDuty * settings_.motor_dead_band;
  robot.left_motor = {max_um_s, factor(wheels, settings_.wheel_gain_error), dead_band};
  robot.right_motor = {max_um_s, factor(wheels, settings_.wheel_gain_error), dead_band};
  Random wheel_base(stream("wheel base"));
  robot.wheel_base = settings_.wheel_base * factor(wheel_base, settings_.wheel_base_error);
  robot.stored_wheel_base = settings_.wheel_base;
  robot.noise = Random(stream("noise"));
  robot.light_noise = Random(stream("light"));
  Random light_gains(stream("light gains"));
  robot.light_gains.front = factor(light_gains, settings_.light_gain_error);
  robot.light_gains.back = factor(light_gains, settings_.light_gain_error);
  robot.battery_full = kBatteryFull + kBatterySpread * Random(stream("battery")).normal();
  robot.core.seed(stream("program"));

  const double rate = factor(clock, settings_.clock_error);
  robot.clock = RobotClock(kLargestPhaseMs * clock.uniform(), rate);
  robot.local_ms = robot.clock.localMs(0);
  robot.boot = settings_.boot_spread * clock.uniform();
  const double scan_phase = robot.core.settings().sensor_period_ms * clock.uniform();
  robot.next_scan_ms = robot.clock.localMs(robot.boot) + 1 + static_cast<std::int64_t>(scan_phase);
  robot.next_event_ms = robot.next_scan_ms;

  next_event_.push_back(setup.external ? kNever : robot.clock.worldTime(robot.next_event_ms));
  electronics_.push_back(robot);
}

void World::setThreads(std::size_t threads) {
  // Fewer robots move as one group.
  team_ = std::make_shared<WorkerTeam>(size() > kGroup ? threads : 1);
}

void World::setMotors(std::size_t i, const MotorChange& change) {
  Electronics& robot = electronics_[i];
  if (robot.next_change == robot.changes.size()) {
    robot.changes.clear();
    robot.next_change = 0;
    next_event_[i] = static_cast<double>(change.at_us) * 1e-6;
  }
  robot.changes.push_back(change);
}

void World::setCalibration(std::size_t i, const dynamics::WheelCalibration& left,
                           const dynamics::WheelCalibration& right, double wheel_base) {
  electronics_[i].left_calibration = left;
  electronics_[i].right_calibration = right;
  electronics_[i].stored_wheel_base = wheel_base;
  drive(i, electronics_[i].wheels);
}

void World::step(std::int64_t dt_us) {
  const double from = time();
  time_us_ += dt_us;
  disks_.beginStep();
  const double to = time();
  if (settings_.contact == ContactRule::kStop) {
    stepOneByOne(from, to);
  } else {
    stepTogether(from, to);
  }
  disks_.endStep(to - from, *team_);
}

void World::stepOneByOne(double from, double to) {
  for (std::size_t i = 0; i < size(); ++i) {
    double now = from;
    while (advanceToScan(i, now, to)) scanNow(i);
    if (isNoisy()) addNoise(i, to - from);
    disks_.relistIfMoved(i);
  }
}

// Robots do not interact while they move. Groups of them have a fixed size, so that every robot is
// treated alike with any number of threads; one group's data fit into a processor's cache.
void World::stepTogether(double from, double to) {
  moves_.resize(size());
  scratch_.resize(team_->size());
  const std::size_t groups = (size() + kGroup - 1) / kGroup;
  team_->run(groups, [&](std::size_t group, std::size_t worker) {
    advanceGroup(group * kGroup, std::min((group + 1) * kGroup, size()), from, to,
                 scratch_[worker]);
  });
}

// Moves a group of robots up to their next scans, evaluates the light there at once, and so on
// until no robot has a scan left in this step.
void World::advanceGroup(std::size_t begin, std::size_t end, double from, double to,
                         Scratch& scratch) {
  const std::size_t robots = end - begin;
  const double* next = next_event_.data();
  double* moves = moves_.data();
  for (std::size_t i = begin; i < end; ++i) {
    const double until = next[i] < to ? next[i] : to;
    moves[i] = until > from ? until - from : 0;
  }
  disks_.moveEach(begin, end, moves);
  // Without branches, which a processor would guess wrong for every second robot.
  scratch.due.resize(robots);
  std::size_t due = 0;
  for (std::size_t i = begin; i < end; ++i) {
    scratch.due[due] = static_cast<std::uint32_t>(i);
    due += next[i] <= to ? 1U : 0U;
  }
  Scans& scans = scratch.scans;
  Scans& next_scans = scratch.next_scans;
  scans.begin(due);
  for (std::size_t k = 0; k < due; ++k) {
    if (k + kFetchAhead < due) fetch(&electronics_[scratch.due[k + kFetchAhead]]);
    const std::size_t i = scratch.due[k];
    double now = std::max(from, next_event_[i]);
    if (advanceToScan(i, now, to)) scans.add(i, now, sensors_.lightPlaces(disks_, i));
  }
  while (scans.count > 0) {
    sensors_.lightAt(scans.x.data(), scans.y.data(), 2 * scans.count, scans.light.data());
    for (std::size_t k = 0; k < scans.count; ++k) {
      scan(scans.robots[k], scans.light[2 * k], scans.light[2 * k + 1]);
    }
    moveAfterScans(begin, end, to, scans);
    next_scans.begin(scans.count);
    for (std::size_t k = 0; k < scans.count; ++k) {
      const std::size_t i = scans.robots[k];
      if (next_event_[i] > to) continue;
      double now = std::max(scans.at[k], next_event_[i]);
      if (advanceToScan(i, now, to)) next_scans.add(i, now, sensors_.lightPlaces(disks_, i));
    }
    std::swap(scans, next_scans);
  }
  if (isNoisy()) {
    for (std::size_t i = begin; i < end; ++i) addNoise(i, to - from);
  }
}

// Moves robots of a group from their scans to their next events, or to the end of the step.
void World::moveAfterScans(std::size_t begin, std::size_t end, double to, const Scans& scans) {
  const bool many = scans.count > (end - begin) / 6;  // several at a time, with those that stay
  if (many) std::fill_n(moves_.begin() + static_cast<std::ptrdiff_t>(begin), end - begin, 0.0);
  for (std::size_t k = 0; k < scans.count; ++k) {
    const std::size_t i = scans.robots[k];
    const double move = std::min(next_event_[i], to) - scans.at[k];
    if (move <= 0) continue;
    if (many) {
      moves_[i] = move;
    } else {
      disks_.moveFor(i, move);
    }
  }
  if (many) disks_.moveEach(begin, end, moves_.data());
}

void World::advanceTo(std::int64_t time_us) {
  while (time_us_ < time_us) {
    const std::int64_t next_tick = (time_us_ / settings_.tick_us + 1) * settings_.tick_us;
    step(std::min(next_tick, time_us) - time_us_);
  }
}

// Advances robot i to its next scan, or to the end of the step. @return whether there is a scan
bool World::advanceToScan(std::size_t i, double& now, double to) {
  while (next_event_[i] <= to) {
    // An order may have left an event that is already due.
    if (next_event_[i] > now) {
      disks_.moveFor(i, next_event_[i] - now);
      now = next_event_[i];
    }
    Electronics& robot = electronics_[i];
    if (robot.external) {
      changeMotors(i);
      continue;
    }
    robot.local_ms = robot.next_event_ms;
    if (robot.local_ms == robot.next_scan_ms) return true;
    robot.core.advanceTo(static_cast<std::uint32_t>(robot.local_ms));
    afterCore(i);
  }
  disks_.moveFor(i, to - now);
  return false;
}

void World::addNoise(std::size_t i, double dt) {
  if (!disks_.isMoving(i)) {
    return;
  }
  Random& random = electronics_[i].noise;
  const double root = std::sqrt(dt);
  const double forward = settings_.speed_noise * root * random.normal();
  const double rotation = settings_.turn_noise * root * random.normal();
  disks_.displace(i, forward, rotation);
}

void World::scanNow(std::size_t i) {
  const auto [front, back] = sensors_.lightPlaces(disks_, i);
  const std::array<double, 2> x = {front.x, back.x};
  const std::array<double, 2> y = {front.y, back.y};
  std::array<double, 2> light{};
  sensors_.lightAt(x.data(), y.data(), 2, light.data());
  scan(i, light[0], light[1]);
}

// Reads the sensors at the robot's present time and passes the readings to its core.
void World::scan(std::size_t i, double front, double back) {
  Electronics& robot = electronics_[i];
  robot.last_scan_ms = robot.next_scan_ms;
  robot.next_scan_ms += std::max<std::int64_t>(1, robot.core.settings().sensor_period_ms);
  const SensorScan readings =
      sensors_.scan(disks_, i, robot.light_gains, front, back, robot.light_noise);
  robot.sensors = readings.all;
  const double battery = robot.battery_full - kBatteryFall * time();
  robot.core.setBattery(roundedCounts(std::max(0.0, battery) * 1e3));
  robot.core.sense(static_cast<std::uint32_t>(robot.local_ms),
                   robot.reverses_from_robots ? readings.all : readings.walls_only);
  afterCore(i);
}

// Applies the next motor change of an external robot.
void World::changeMotors(std::size_t i) {
  Electronics& robot = electronics_[i];
  const MotorChange change = robot.changes[robot.next_change++];
  turnWheels(i, robot.left_motor.speed(change.left), robot.right_motor.speed(change.right));
  const bool more = robot.next_change < robot.changes.size();
  next_event_[i] =
      more ? static_cast<double>(robot.changes[robot.next_change].at_us) * 1e-6 : kNever;
}

void World::drive(std::size_t i, dynamics::WheelSpeedsUmS wheels) {
  Electronics& robot = electronics_[i];
  robot.wheels = wheels;
  turnWheels(
      i, drivenSpeed(wheels.left, robot.left_motor, robot.left_calibration, settings_.pwm_steps),
      drivenSpeed(wheels.right, robot.right_motor, robot.right_calibration, settings_.pwm_steps));
}

void World::turnWheels(std::size_t i, double left, double right) {
  disks_.setMotion(i, {(left + right) / 2, (right - left) / electronics_[i].wheel_base});
}

// Applies the core's wheel speeds and schedules the robot's next event.
void World::afterCore(std::size_t i) {
  Electronics& robot = electronics_[i];
  const dynamics::WheelSpeedsUmS wheels = robot.core.wheels();
  if (wheels.left != robot.wheels.left || wheels.right != robot.wheels.right) {
    drive(i, wheels);
  }
  const auto now_ms = static_cast<std::uint32_t>(robot.local_ms);
  const std::int64_t core_ms = unwrapMs(robot.core.nextEventMs(now_ms), robot.local_ms);
  robot.next_event_ms = std::min(core_ms, robot.next_scan_ms);
  next_event_[i] = robot.clock.worldTime(robot.next_event_ms);
}

RobotState World::state(std::size_t i) const {
  const Electronics& robot = electronics_[i];
  const auto world_time = [&](std::uint32_t ms) {
    return robot.clock.worldTime(unwrapMs(ms, robot.local_ms));
  };
  RobotState state;
  state.id = robot.id;
  state.external = robot.external;
  state.pose = pose(i);
  state.wheel_left = robot.wheels.left * kMicro;
  state.wheel_right = robot.wheels.right * kMicro;
  state.core = robot.core.report();
  state.program_left = state.core.held.left * kMicro;
  state.program_right = state.core.held.right * kMicro;
  state.program_start = state.core.program_epoch == 0 ? 0 : world_time(state.core.program_start_ms);
  if (state.core.reversal_count > 0) {
    state.reversal_start = world_time(state.core.reversal_start_ms);
    state.reversal_end = world_time(state.core.reversal_end_ms);
  }
  state.run_time =
      robot.core.runTimeMs(static_cast<std::uint32_t>(robot.clock.localMs(time()))) * 1e-3;
  state.sensors = robot.external ? measure(i) : robot.sensors;
  state.sampled_at = robot.last_scan_ms < 0 ? time() : robot.clock.worldTime(robot.last_scan_ms);
  state.battery = robot.battery_full - kBatteryFall * time();
  state.contact_robot = disks_.touchesRobot(i);
  state.contact_wall = disks_.touchesWall(i);
  state.robot_contacts = disks_.robotContacts(i);
  state.wall_contacts = disks_.wallContacts(i);
  return state;
}

}  // namespace lab::sim
