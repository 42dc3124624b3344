#include "sim_svc/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_svc/placement.hpp"
#include "sim_svc/world/collision.hpp"

namespace lab::sim {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kLargestPhaseMs = 60000;
constexpr double kBatteryFull = 4.15;    // V, of a Li-ion cell
constexpr double kBatterySpread = 0.02;  // V

double squared(Vec v) { return v.x * v.x + v.y * v.y; }

std::vector<dynamics::Pose> place(const WorldSettings& settings,
                                  const std::vector<RobotSetup>& robots) {
  std::vector<Place> places;
  places.reserve(robots.size());
  for (const RobotSetup& robot : robots) {
    places.push_back({robot.id, robot.pose});
  }
  return placeRobots(places, settings.arena, settings.radius, settings.seed);
}

// A wheel or a clock is never so wrong that the bounds of the neighbour list fail.
double factor(Random& random, double error) {
  return std::clamp(1 + error * random.normal(), 0.5, 1.5);
}

}  // namespace

World::World(const WorldSettings& settings, const std::vector<RobotSetup>& robots)
    : settings_(settings),
      contact_distance_(2 * settings.radius + kContactGap),
      skin_(settings.radius),
      largest_move_(0) {
  const double tick = static_cast<double>(settings.tick_us) * 1e-6;
  largest_move_ =
      std::max(1.5 * settings.max_wheel_speed * tick, 5 * settings.speed_noise * std::sqrt(tick)) +
      1e-6;
  const std::vector<dynamics::Pose> poses = place(settings, robots);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    addRobot(robots[i], poses[i]);
  }
  listNeighbours();
}

void World::addRobot(const RobotSetup& setup, const dynamics::Pose& pose) {
  const auto stream = [&](const char* purpose) {
    return deriveSeed(settings_.seed, setup.id, purpose);
  };
  Random clock(stream("clock"));
  Random wheels(stream("wheels"));
  Electronics robot;
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
  robot.front_gain = factor(light_gains, settings_.light_gain_error);
  robot.back_gain = factor(light_gains, settings_.light_gain_error);
  robot.battery_full = kBatteryFull + kBatterySpread * Random(stream("battery")).normal();
  robot.core.seed(stream("program"));

  const double rate = factor(clock, settings_.clock_error);
  robot.clock = RobotClock(kLargestPhaseMs * clock.uniform(), rate);
  robot.local_ms = robot.clock.localMs(0);
  robot.boot = settings_.boot_spread * clock.uniform();
  const double scan_phase = robot.core.settings().sensor_period_ms * clock.uniform();
  robot.next_scan_ms = robot.clock.localMs(robot.boot) + 1 + static_cast<std::int64_t>(scan_phase);
  robot.next_event_ms = robot.next_scan_ms;

  Body body;
  body.theta = pose.theta;
  body.heading = {std::cos(pose.theta), std::sin(pose.theta)};
  body.next_event = setup.external ? kNever : robot.clock.worldTime(robot.next_event_ms);

  electronics_.push_back(robot);
  bodies_.push_back(body);
  centres_.push_back({pose.x, pose.y});
}

void World::setMotors(std::size_t i, const MotorChange& change) {
  Electronics& robot = electronics_[i];
  if (robot.next_change == robot.changes.size()) {
    robot.changes.clear();
    robot.next_change = 0;
    bodies_[i].next_event = static_cast<double>(change.at_us) * 1e-6;
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
  ++steps_;
  const double to = time();
  if (shown_kinematic_ > 0) {
    for (std::size_t ghost = size(); ghost < bodies_.size(); ++ghost) {
      makeRoom(ghost);
    }
  }
  for (std::size_t i = 0; i < size(); ++i) {
    advanceRobot(i, from, to);
  }
}

void World::advanceTo(std::int64_t time_us) {
  while (time_us_ < time_us) {
    const std::int64_t next_tick = (time_us_ / settings_.tick_us + 1) * settings_.tick_us;
    step(std::min(next_tick, time_us) - time_us_);
  }
}

void World::advanceRobot(std::size_t i, double from, double to) {
  Body& body = bodies_[i];
  double now = from;
  while (body.next_event <= to) {
    // An order may have left an event that is due already.
    if (body.next_event > now) {
      moveFor(i, body.next_event - now);
      now = body.next_event;
    }
    handleEvent(i);
  }
  moveFor(i, to - now);
  if (settings_.speed_noise > 0 || settings_.turn_noise > 0) {
    addNoise(i, to - from);
  }
  relistIfMoved(i);
}

void World::relistIfMoved(std::size_t i) {
  const Vec listed_at = bodies_[i].listed_at;
  const Vec moved = {centres_[i].x - listed_at.x, centres_[i].y - listed_at.y};
  if (squared(moved) > skin_ * skin_ / 4) {
    listNeighbours();
  }
}

void World::handleEvent(std::size_t i) {
  Electronics& robot = electronics_[i];
  if (robot.external) {
    changeMotors(i);
    return;
  }
  robot.local_ms = robot.next_event_ms;
  if (robot.local_ms == robot.next_scan_ms) {
    scan(i);
  } else {
    robot.core.advanceTo(static_cast<std::uint32_t>(robot.local_ms));
  }
  afterCore(i);
}

void World::moveFor(std::size_t i, double dt) {
  Body& body = bodies_[i];
  if (body.speed == 0 && body.turn == 0) {
    return;
  }
  const dynamics::Arc arc = dynamics::makeArcOf(body.speed, body.turn, dt);
  const Vec along = body.heading;
  const Vec move =
      stopAtContact(i, {along.x * arc.dx - along.y * arc.dy, along.y * arc.dx + along.x * arc.dy});
  centres_[i].x += move.x;
  centres_[i].y += move.y;
  body.theta += arc.dtheta;
  // The heading turns with the arc; drive() computes it anew from theta at every change of speed.
  body.heading = {along.x * arc.cos_turn - along.y * arc.sin_turn,
                  along.y * arc.cos_turn + along.x * arc.sin_turn};
}

Vec World::stopAtContact(std::size_t i, Vec move) {
  const Vec from = centres_[i];
  const double reach = contact_distance_ + largest_move_;
  const double wall_share = freeShareToWalls(settings_.arena, settings_.radius, from, move);
  double share = wall_share;
  std::size_t touched = i;
  for (const std::uint32_t j : neighbours_.of(i)) {
    const Vec to_other = {centres_[j].x - from.x, centres_[j].y - from.y};
    if (squared(to_other) >= reach * reach) {
      continue;
    }
    const double free = freeShareToDisk(to_other, move, contact_distance_ * contact_distance_);
    if (free < share) {
      share = free;
      touched = j;
    }
  }
  if (share == 1) {
    return move;
  }
  if (touched == i) {
    touch(bodies_[i].wall_contact);
  } else {
    const bool begun = touch(bodies_[i].robot_contact);
    touch(bodies_[touched].robot_contact);
    collisions_ += begun ? 1 : 0;
  }
  return {share * move.x, share * move.y};
}

// Marks a contact in this step; true if it was not there in the step before.
bool World::touch(Contact& contact) const {
  const bool begun = contact.last_step < steps_ - 1;
  contact.begun += begun ? 1 : 0;
  contact.last_step = steps_;
  return begun;
}

void World::addNoise(std::size_t i, double dt) {
  Body& body = bodies_[i];
  if (body.speed == 0 && body.turn == 0) {
    return;
  }
  Random& random = electronics_[i].noise;
  const double root = std::sqrt(dt);
  const double forward =
      std::clamp(settings_.speed_noise * root * random.normal(), -largest_move_, largest_move_);
  const Vec move = stopAtContact(i, {forward * body.heading.x, forward * body.heading.y});
  centres_[i].x += move.x;
  centres_[i].y += move.y;
  body.theta += settings_.turn_noise * root * random.normal();
  body.heading = {std::cos(body.theta), std::sin(body.theta)};
}

// The next change of an external robot's motors is due.
void World::changeMotors(std::size_t i) {
  Electronics& robot = electronics_[i];
  const MotorChange change = robot.changes[robot.next_change++];
  turnWheels(i, robot.left_motor.speed(change.left), robot.right_motor.speed(change.right));
  const bool more = robot.next_change < robot.changes.size();
  bodies_[i].next_event =
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
  Body& body = bodies_[i];
  body.speed = (left + right) / 2;
  body.turn = (right - left) / electronics_[i].wheel_base;
  body.heading = {std::cos(body.theta), std::sin(body.theta)};
}

// Takes over what the core wants now, and when something happens next.
void World::afterCore(std::size_t i) {
  Electronics& robot = electronics_[i];
  const dynamics::WheelSpeedsUmS wheels = robot.core.wheels();
  if (wheels.left != robot.wheels.left || wheels.right != robot.wheels.right) {
    drive(i, wheels);
  }
  const auto now_ms = static_cast<std::uint32_t>(robot.local_ms);
  const std::int64_t core_ms = unwrapMs(robot.core.nextEventMs(now_ms), robot.local_ms);
  robot.next_event_ms = std::min(core_ms, robot.next_scan_ms);
  bodies_[i].next_event = robot.clock.worldTime(robot.next_event_ms);
}

void World::listNeighbours() {
  const double reach =
      std::max(2 * settings_.radius + settings_.ir_range, contact_distance_ + largest_move_);
  neighbours_.build(centres_, settings_.arena, reach + skin_ + largest_move_);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].listed_at = centres_[i];
  }
}

}  // namespace lab::sim
