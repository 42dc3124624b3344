/// The simulated robots in their arena: a pure, seeded world.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/math/random.hpp"
#include "robot/dynamics/kinematics.hpp"
#include "robot/dynamics/robot_core.hpp"
#include "sim_svc/world/arena.hpp"
#include "sim_svc/world/ir_scan.hpp"
#include "sim_svc/world/neighbour_list.hpp"
#include "sim_svc/world/robot_clock.hpp"
#include "sim_svc/world/wheel_motor.hpp"

namespace lab::sim {

/// The robots as hardware. Errors are standard deviations over the robots; each robot draws its own
/// from its own random stream.
struct WorldSettings {
  Arena arena;
  std::uint64_t seed = 1;
  double radius = 0.0375;         ///< Of a robot, m.
  double wheel_base = 0.075;      ///< d, m.
  double max_wheel_speed = 0.27;  ///< At full duty, m/s.
  bool pwm_steps = true;          ///< 256 levels, rounded to nearest; false: ideal wheels.
  double wheel_gain_error = 0;    ///< Of each wheel's speed, relative.
  double wheel_base_error = 0;    ///< Of the distance between the wheels, relative.
  double motor_dead_band = 0;     ///< Of all wheels, as a share of full duty.
  double speed_noise = 0;         ///< Random forward displacement of a moving robot, m/sqrt(s).
  double turn_noise = 0;          ///< Random rotation of a moving robot, rad/sqrt(s).
  double clock_error = 0.005;     ///< Of each robot's clock rate, relative.
  double boot_spread = 1;         ///< Robots boot at random instants in the first so many seconds.
  double ir_range = 0.05;         ///< From the rim, m.
  double light_offset = 0.03;     ///< The light sensors are this far before and behind the axle, m.
  double light_noise = 0;         ///< Of a light reading, counts.
  double light_gain_error = 0;    ///< Of each light sensor's gain, relative.
  std::int64_t tick_us = 10000;   ///< Longest step, microseconds.
};

/// One robot at the beginning.
struct RobotSetup {
  std::int32_t id = 0;
  std::optional<dynamics::Pose> pose;  ///< At random, without overlap, where not given.
  bool external = false;               ///< Driven by setMotors() instead of a core of its own.
};

/// The motors of an external robot from an instant on.
struct MotorChange {
  std::int64_t at_us = 0;  ///< World time, microseconds.
  std::int16_t left = 0;   ///< Signed duty, -255..255.
  std::int16_t right = 0;  ///< Signed duty, -255..255.
};

/// One robot as its electronics report it and as it really is. Times are world seconds.
struct RobotState {
  std::int32_t id = 0;
  bool external = false;     ///< Driven from outside; of core, wheels and program nothing is known.
  dynamics::Pose pose;       ///< True pose; theta is not wrapped.
  double sampled_at = 0;     ///< When the sensors were last read.
  double wheel_left = 0;     ///< As commanded now, m/s.
  double wheel_right = 0;    ///< As commanded now, m/s.
  double program_left = 0;   ///< As held by the program, also while it is paused, m/s.
  double program_right = 0;  ///< As held by the program, also while it is paused, m/s.
  dynamics::CoreReport core;   ///< Its times are the robot's own; see below.
  double program_start = 0;    ///< When the running program (or standing) began.
  double reversal_start = 0;   ///< When the last reversal began; read it if reversal_count > 0.
  double reversal_end = 0;     ///< When the last finished reversal ended.
  double run_time = 0;         ///< In runs of a run-and-tumble program, s of the robot's clock.
  dynamics::Sensors sensors;   ///< Robots are in ir also where they are not seen for reversal.
  double battery = 0;          ///< V.
  bool contact_robot = false;  ///< Touched another robot in the last step.
  bool contact_wall = false;   ///< Touched a wall in the last step.
  std::int64_t robot_contacts = 0;  ///< Contacts with robots begun since the start.
  std::int64_t wall_contacts = 0;   ///< Contacts with walls begun since the start.
};

/// How a robot moves.
struct Motion {
  double speed = 0;  ///< Forward, m/s.
  double turn = 0;   ///< rad/s.
};

/// N robots, each with a RobotCore on a clock of its own, in one arena.
///
/// Deterministic: the same settings, setups, light and calls give the same bits. Every random
/// number comes from a stream of (seed, robot id, purpose), so that a robot added changes no
/// other's.
///
/// Robots move one after the other, in the order of their setups, each from one instant to the next
/// along exact arcs: what a robot's core does happens at the exact time of its own clock inside the
/// step. A move stops where the robot would touch another robot or a wall (nothing is pushed and
/// nothing slides), while the heading turns on; so robots never overlap. A robot meets the others
/// where they stand at that moment, at most one tick (2.7 mm at full speed) from their place.
///
/// KinematicRobots are disks that something outside the world moves: real robots that a camera
/// sees, or recorded ones. Robots meet and sense them like each other, and yield: see
/// moveKinematicDisk().
///
/// A robot boots at a random instant: before it, its sensors are silent, and as no light band is
/// known, no program starts. Cores also need settings and a lease: see order().
class World {
 public:
  /// @throws std::invalid_argument when robots do not fit or are named twice (see placeRobots)
  World(const WorldSettings& settings, const std::vector<RobotSetup>& robots);

  /// The light on the arena from now on; nullptr is dark. It must outlive its use here.
  void setLight(const LightSampler* light) { light_ = light; }

  /// Gives an order to the core of robot i (not an external one): `give` is called with the core
  /// and the robot's time. world.order(i, [](auto& core, auto now_ms) { core.stop(now_ms); });
  template <class Give>
  void order(std::size_t i, Give give) {
    Electronics& robot = electronics_[i];
    robot.local_ms = std::max(robot.local_ms, robot.clock.localMs(time()));
    give(robot.core, static_cast<std::uint32_t>(robot.local_ms));
    afterCore(i);
  }

  /// Whether robot i takes other robots for obstacles to reverse from (as on hardware), or walls
  /// only.
  void setRobotsSeen(std::size_t i, bool seen) { electronics_[i].sees_robots = seen; }

  /// Sets the motors of an external robot at an instant that may lie in the steps to come. Changes
  /// come in the order of their times; one that is late holds from now on.
  void setMotors(std::size_t i, const MotorChange& change);

  /// Stores in robot i (not an external one) what a calibration found; the robot then drives what
  /// it is told as well as the calibration is right. As stored at first: no dead band, gain 1.
  /// @param wheel_base m, for whoever converts an order into wheel speeds
  void setCalibration(std::size_t i, const dynamics::WheelCalibration& left,
                      const dynamics::WheelCalibration& right, double wheel_base);

  /// What setCalibration() stored in robot i.
  [[nodiscard]] const dynamics::WheelCalibration& storedLeft(std::size_t i) const {
    return electronics_[i].left_calibration;
  }
  [[nodiscard]] const dynamics::WheelCalibration& storedRight(std::size_t i) const {
    return electronics_[i].right_calibration;
  }

  /// The wheel base that robot i believes, m.
  [[nodiscard]] double storedWheelBase(std::size_t i) const {
    return electronics_[i].stored_wheel_base;
  }

  /// Adds a ghost, hidden. @return its number, from 0.
  std::size_t addKinematicDisk();

  /// Puts a ghost at a place, also outside the arena. Robots that it would overlap are pushed out
  /// along the line of centres, as far as walls, other robots and other ghosts allow; what cannot
  /// move now moves as soon as it can. A place that is no number hides the ghost.
  void moveKinematicDisk(std::size_t ghost, Vec centre);

  /// Takes a ghost out of the arena.
  void hideKinematicDisk(std::size_t ghost);

  /// What the sensors of robot i would read now (without the random noise of light_noise).
  [[nodiscard]] dynamics::Sensors measure(std::size_t i) const;

  /// Makes one step of dt_us (1 to tick_us) microseconds.
  void step(std::int64_t dt_us);

  /// Steps to the given time, in ticks from multiples of the tick.
  void advanceTo(std::int64_t time_us);

  [[nodiscard]] std::int64_t timeUs() const { return time_us_; }
  [[nodiscard]] double time() const { return static_cast<double>(time_us_) * 1e-6; }
  /// How many robots there are; ghosts are not among them.
  [[nodiscard]] std::size_t size() const { return electronics_.size(); }
  [[nodiscard]] std::int32_t id(std::size_t i) const { return electronics_[i].id; }
  [[nodiscard]] const WorldSettings& settings() const { return settings_; }
  [[nodiscard]] RobotState state(std::size_t i) const;
  [[nodiscard]] dynamics::Pose pose(std::size_t i) const;

  /// How robot i moves now. Held by a wall or another robot, it only turns.
  [[nodiscard]] Motion motion(std::size_t i) const;
  [[nodiscard]] const dynamics::RobotCore& core(std::size_t i) const {
    return electronics_[i].core;
  }
  [[nodiscard]] const RobotClock& clock(std::size_t i) const { return electronics_[i].clock; }

  /// When robot i is switched on, world s.
  [[nodiscard]] double bootTime(std::size_t i) const { return electronics_[i].boot; }

  /// Contacts between two robots begun since the start.
  [[nodiscard]] std::int64_t collisions() const { return collisions_; }

 private:
  struct Contact {
    std::int64_t last_step = -2;
    std::int64_t begun = 0;
  };

  /// What moves: kept apart from the electronics, so that a thousand of them stay in the cache.
  struct Body {
    double theta = 0;
    Vec heading{1, 0};
    double speed = 0;       ///< Really driven, m/s.
    double turn = 0;        ///< Really turned, rad/s.
    double next_event = 0;  ///< Of the electronics, world s.
    Vec listed_at;          ///< Where it was when the neighbours were listed.
    Contact robot_contact;
    Contact wall_contact;
  };

  struct Electronics {
    std::int32_t id = 0;
    bool external = false;
    bool sees_robots = true;
    dynamics::WheelSpeedsUmS wheels;  ///< As commanded now.
    std::int64_t local_ms = 0;        ///< The robot's time of the last event or order.
    std::int64_t next_event_ms = 0;
    std::int64_t next_scan_ms = 0;
    std::int64_t last_scan_ms = -1;  ///< Negative: none yet.
    RobotClock clock;
    dynamics::Sensors sensors;
    dynamics::RobotCore core;
    double boot = 0;  ///< World s.
    WheelMotor left_motor;
    WheelMotor right_motor;
    double wheel_base = 0;  ///< As it is, m.
    dynamics::WheelCalibration left_calibration;
    dynamics::WheelCalibration right_calibration;
    double stored_wheel_base = 0;      ///< As the robot believes, m.
    std::vector<MotorChange> changes;  ///< Of an external robot, in order of time.
    std::size_t next_change = 0;       ///< The first one still to come.
    double battery_full = 0;           ///< V.
    Random noise{0};
    Random light_noise{0};
    double front_gain = 1;  ///< Of the light sensor.
    double back_gain = 1;
  };

  void addRobot(const RobotSetup& setup, const dynamics::Pose& pose);
  void advanceRobot(std::size_t i, double from, double to);
  void moveFor(std::size_t i, double dt);
  [[nodiscard]] Vec stopAtContact(std::size_t i, Vec move);
  void addNoise(std::size_t i, double dt);
  bool touch(Contact& contact) const;
  void handleEvent(std::size_t i);
  void changeMotors(std::size_t i);
  void scan(std::size_t i);
  void afterCore(std::size_t i);
  void drive(std::size_t i, dynamics::WheelSpeedsUmS wheels);
  void turnWheels(std::size_t i, double left, double right);
  void makeRoom(std::size_t ghost_body);
  void pushOut(std::size_t i, std::size_t ghost_body);
  void relistIfMoved(std::size_t i);
  void senseLight(std::size_t i, dynamics::Sensors& sensors) const;
  [[nodiscard]] std::uint16_t lightCounts(Vec at, double gain) const;
  void addRobots(std::size_t i, IrScan& ir) const;
  void listNeighbours();

  WorldSettings settings_;
  const LightSampler* light_ = nullptr;
  std::int64_t time_us_ = 0;
  std::int64_t steps_ = 0;
  std::int64_t collisions_ = 0;
  double contact_distance_;
  double skin_;
  double largest_move_;
  NeighbourList neighbours_;
  // Robots first, then ghosts; electronics for robots only.
  std::vector<Vec> centres_;
  std::vector<Body> bodies_;
  std::vector<Electronics> electronics_;
  std::size_t shown_kinematic_ = 0;
};

}  // namespace lab::sim
