/// The simulated robots in their arena. Pure and deterministic: no clock, no bus.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/math/random.hpp"
#include "common/programs/program_library.hpp"
#include "robot/dynamics/kinematics.hpp"
#include "robot/dynamics/robot_core.hpp"
#include "sim_svc/world/arena.hpp"
#include "sim_svc/world/disk_arena.hpp"
#include "sim_svc/world/robot_clock.hpp"
#include "sim_svc/world/sensor_model.hpp"
#include "sim_svc/world/wheel_motor.hpp"
#include "sim_svc/world/worker_team.hpp"

namespace lab::sim {

/// The hardware of the robots. Errors are standard deviations over the robots; each robot draws its
/// own values from its own random stream.
struct WorldSettings {
  Arena arena;
  std::uint64_t seed = 1;
  double radius = 0.0375;         ///< Of a robot [m].
  double wheel_base = 0.075;      ///< d [m].
  double max_wheel_speed = 0.27;  ///< At full duty [m/s].
  bool pwm_steps = true;          ///< 256 levels, rounded to nearest; false: ideal wheels.
  double wheel_gain_error = 0;    ///< Of each wheel's speed, relative.
  double wheel_base_error = 0;    ///< Of the distance between the wheels, relative.
  double motor_dead_band = 0;     ///< Of all wheels, as a share of full duty.
  double speed_noise = 0;         ///< Random forward displacement of a moving robot [m/sqrt(s)].
  double turn_noise = 0;          ///< Random rotation of a moving robot [rad/sqrt(s)].
  double clock_error = 0.005;     ///< Of each robot's clock rate, relative.
  double boot_spread = 1;         ///< Robots boot at random times between 0 and this [s].
  ContactRule contact = ContactRule::kSlide;
  double contact_friction = 0.2;  ///< Coefficient between rims, and between rim and wall.
  SlipMobility slip;              ///< How contact forces move robots against their wheels.
  double ir_range = 0.05;         ///< From the rim [m].
  double light_offset = 0.03;     ///< Distance of the light sensors before and behind the axle [m].
  double light_noise = 0;         ///< Of a light reading [counts].
  double light_gain_error = 0;    ///< Of each light sensor's gain, relative.
  std::int64_t tick_us = 10000;   ///< Longest step [us]; the world shortens it for fast robots.
};

/// One robot at the start.
struct RobotSetup {
  std::int32_t id = 0;
  std::optional<dynamics::Pose> pose;  ///< Empty: at random, without overlap.
  bool external = false;               ///< Driven by setMotors() instead of a RobotCore.
};

/// A change of the motor duties of an external robot.
struct MotorChange {
  std::int64_t at_us = 0;  ///< World time [us].
  std::int16_t left = 0;   ///< Signed duty, -255..255.
  std::int16_t right = 0;  ///< Signed duty, -255..255.
};

/// The state of one robot: its true pose, and what its electronics report. Times are world seconds.
struct RobotState {
  std::int32_t id = 0;
  bool external = false;            ///< Driven from outside; core, wheels and program are not set.
  dynamics::Pose pose;              ///< True pose; theta is not wrapped.
  double sampled_at = 0;            ///< When the sensors were last read.
  double wheel_left = 0;            ///< As commanded now [m/s].
  double wheel_right = 0;           ///< As commanded now [m/s].
  double program_left = 0;          ///< Held by the program, also while it is paused [m/s].
  double program_right = 0;         ///< Held by the program, also while it is paused [m/s].
  dynamics::CoreReport core;        ///< Its times are in the robot's own milliseconds.
  double program_start = 0;         ///< When the running program (or standing) began.
  double reversal_start = 0;        ///< When the last reversal began; valid if reversal_count > 0.
  double reversal_end = 0;          ///< When the last finished reversal ended.
  double run_time = 0;              ///< Time in first phases [s of the robot's clock].
  dynamics::Sensors sensors;        ///< Includes other robots even if the core ignores them.
  double battery = 0;               ///< Voltage [V].
  bool contact_robot = false;       ///< Touched another robot in the last step.
  bool contact_wall = false;        ///< Touched a wall in the last step.
  std::int64_t robot_contacts = 0;  ///< Contacts with robots begun since the start.
  std::int64_t wall_contacts = 0;   ///< Contacts with walls begun since the start.
};

/// N robots, each with a RobotCore on its own clock, in one arena.
///
/// Deterministic: the same settings, setups, light and calls give the same bits. Every random
/// number comes from a stream of (seed, robot id, purpose), so adding a robot does not change the
/// others' random streams.
///
/// Each robot moves through the whole step along exact arcs; events of its core happen at the exact
/// time of its own clock inside the step. It senses the others where they were at the start of the
/// step, at most one tick ago (2.7 mm at full speed). At the end of the step, contact forces remove
/// the overlaps (ContactRule::kSlide): robots slide along each other and along walls, push each
/// other and turn each other. The wheels turn as they are driven; what the contacts add is slip,
/// which the robots' electronics do not see. Without contacts the arcs remain as they are.
///
/// With ContactRule::kStop robots move one after the other, in the order of their setups, and sense
/// the others where they are. A move stops where the robot would touch another robot or a wall
/// (nothing is pushed and nothing slides), while the rotation continues. With both rules robots do
/// not overlap.
///
/// Kinematic disks are disks that are moved from outside: real robots that a camera sees, or
/// recorded ones. For the sensors and contacts of robots they are like robots that nothing moves.
/// They push robots away: see moveKinematicDisk().
///
/// Each robot boots at a random time. Before that time its sensors give no readings; so no light
/// band is known, and no program starts. Cores also need settings and a lease: see order().
class World {
 public:
  /// @throws std::invalid_argument if the robots do not fit or two have the same id (placeRobots)
  World(const WorldSettings& settings, const std::vector<RobotSetup>& robots);

  /// Lets several threads work on each step. The results have the same bits with any number. The
  /// light and its functions must then allow calls from several threads.
  void setThreads(std::size_t threads);

  /// Sets the light on the arena; nullptr is dark. It must outlive the world or the next call.
  void setLight(const LightSampler* light) { sensors_.setLight(light); }

  /// Makes a program known to all robots, which find it by its hash.
  /// @param code that dynamics::checkByteCode() accepts
  /// @return false if there is no room for it
  bool addProgram(std::uint32_t hash, const std::vector<std::uint8_t>& code) {
    return programs_->add(hash, code);
  }

  /// Gives an order to the core of robot i (not an external one): `give` is called with the core
  /// and the robot's time. world.order(i, [](auto& core, auto now_ms) { core.stop(now_ms); });
  template <class Give>
  void order(std::size_t i, Give give) {
    Electronics& robot = electronics_[i];
    robot.local_ms = std::max(robot.local_ms, robot.clock.localMs(time()));
    give(robot.core, static_cast<std::uint32_t>(robot.local_ms));
    afterCore(i);
  }

  /// Whether robot i reverses from other robots too (as on hardware), or from walls only.
  void setReversesFromRobots(std::size_t i, bool reverses) {
    electronics_[i].reverses_from_robots = reverses;
  }

  /// Sets the motors of an external robot at a time that may lie in future steps. Changes must come
  /// in the order of their times; a late one takes effect now.
  void setMotors(std::size_t i, const MotorChange& change);

  /// Stores a motor calibration in robot i (not an external one), which corrects its duties by it.
  /// The initial calibration has no dead band and gain 1.
  /// @param wheel_base [m], used by callers that convert an order into wheel speeds
  void setCalibration(std::size_t i, const dynamics::WheelCalibration& left,
                      const dynamics::WheelCalibration& right, double wheel_base);

  /// The calibration stored in robot i.
  [[nodiscard]] const dynamics::WheelCalibration& storedLeft(std::size_t i) const {
    return electronics_[i].left_calibration;
  }
  [[nodiscard]] const dynamics::WheelCalibration& storedRight(std::size_t i) const {
    return electronics_[i].right_calibration;
  }

  /// The wheel base stored in robot i [m].
  [[nodiscard]] double storedWheelBase(std::size_t i) const {
    return electronics_[i].stored_wheel_base;
  }

  /// Adds a hidden kinematic disk. @return its number, from 0
  std::size_t addKinematicDisk() { return disks_.addKinematicDisk(); }

  /// Puts a kinematic disk at a position, which may lie outside the arena. Robots that it overlaps
  /// are pushed out, with ContactRule::kSlide together with the robots that they touch, as far as
  /// walls and other disks allow; the rest of the push follows as soon as it is possible. With
  /// kStop a robot that is pushed does not push others. A position that is not finite hides the
  /// disk.
  void moveKinematicDisk(std::size_t disk, Vec centre) { disks_.moveKinematicDisk(disk, centre); }

  /// Takes a kinematic disk out of the arena.
  void hideKinematicDisk(std::size_t disk) { disks_.hideKinematicDisk(disk); }

  /// The sensor readings of robot i now (without the random noise of light_noise).
  [[nodiscard]] dynamics::Sensors measure(std::size_t i) const {
    return sensors_.measure(disks_, i, electronics_[i].light_gains);
  }

  /// Makes one step of dt_us (1 to tick_us) microseconds.
  void step(std::int64_t dt_us);

  /// Steps to the given time; steps end at multiples of the tick.
  void advanceTo(std::int64_t time_us);

  [[nodiscard]] std::int64_t timeUs() const { return time_us_; }
  [[nodiscard]] double time() const { return static_cast<double>(time_us_) * 1e-6; }
  /// Number of robots, without kinematic disks.
  [[nodiscard]] std::size_t size() const { return electronics_.size(); }
  [[nodiscard]] std::int32_t id(std::size_t i) const { return electronics_[i].id; }
  [[nodiscard]] const WorldSettings& settings() const { return settings_; }
  [[nodiscard]] RobotState state(std::size_t i) const;
  [[nodiscard]] dynamics::Pose pose(std::size_t i) const { return disks_.pose(i); }

  /// How robot i really moves now.
  [[nodiscard]] Velocity velocity(std::size_t i) const { return disks_.velocity(i); }
  [[nodiscard]] const dynamics::RobotCore& core(std::size_t i) const {
    return electronics_[i].core;
  }
  [[nodiscard]] const RobotClock& clock(std::size_t i) const { return electronics_[i].clock; }

  /// When robot i is switched on [s of world time].
  [[nodiscard]] double bootTime(std::size_t i) const { return electronics_[i].boot; }

  /// Contacts between two robots begun since the start.
  [[nodiscard]] std::int64_t collisions() const { return disks_.collisions(); }

  /// Counts of the solver of ContactRule::kSlide.
  [[nodiscard]] const SlidingContacts& sliding() const { return disks_.sliding(); }

 private:
  struct Electronics {
    explicit Electronics(dynamics::ProgramSource& programs) : core(programs) {}

    std::int32_t id = 0;
    bool external = false;
    bool reverses_from_robots = true;
    dynamics::WheelSpeedsUmS wheels;  ///< As commanded now.
    std::int64_t local_ms = 0;        ///< The robot's time of the last event or order.
    std::int64_t next_event_ms = 0;
    std::int64_t next_scan_ms = 0;
    std::int64_t last_scan_ms = -1;  ///< Negative: none yet.
    RobotClock clock;
    dynamics::Sensors sensors;
    dynamics::RobotCore core;
    double boot = 0;  ///< World time [s].
    WheelMotor left_motor;
    WheelMotor right_motor;
    double wheel_base = 0;  ///< True value [m].
    dynamics::WheelCalibration left_calibration;
    dynamics::WheelCalibration right_calibration;
    double stored_wheel_base = 0;      ///< From the calibration [m].
    std::vector<MotorChange> changes;  ///< Of an external robot, in order of time.
    std::size_t next_change = 0;       ///< Index of the first change still to come.
    double battery_full = 0;           ///< Voltage [V].
    Random noise{0};
    Random light_noise{0};
    LightGains light_gains;
  };

  /// The robots that read their sensors next in a step, with the light there.
  struct Scans {
    std::size_t count = 0;
    std::vector<std::uint32_t> robots;
    std::vector<double> at;    ///< Per robot [s of world time].
    std::vector<double> x, y;  ///< Of the light sensors [m]: front and back one of each robot.
    std::vector<double> light;

    void begin(std::size_t most) {
      count = 0;
      if (robots.size() >= most) return;
      robots.resize(most);
      at.resize(most);
      for (std::vector<double>* values : {&x, &y, &light}) values->resize(2 * most);
    }
    void add(std::size_t robot, double time, const std::array<Vec, 2>& places) {
      robots[count] = static_cast<std::uint32_t>(robot);
      at[count] = time;
      for (std::size_t sensor = 0; sensor < 2; ++sensor) {
        x[2 * count + sensor] = places[sensor].x;
        y[2 * count + sensor] = places[sensor].y;
      }
      ++count;
    }
  };

  /// Memory of one thread.
  struct Scratch {
    std::vector<std::uint32_t> due;  ///< Robots with an event in the step.
    Scans scans;
    Scans next_scans;
  };

  void addRobot(const RobotSetup& setup);
  void stepOneByOne(double from, double to);
  void stepTogether(double from, double to);
  void advanceGroup(std::size_t begin, std::size_t end, double from, double to, Scratch& scratch);
  bool advanceToScan(std::size_t i, double& now, double to);
  void moveAfterScans(std::size_t begin, std::size_t end, double to, const Scans& scans);
  [[nodiscard]] bool isNoisy() const {
    return settings_.speed_noise > 0 || settings_.turn_noise > 0;
  }
  void addNoise(std::size_t i, double dt);
  void changeMotors(std::size_t i);
  void scanNow(std::size_t i);
  void scan(std::size_t i, double front, double back);
  void afterCore(std::size_t i);
  void drive(std::size_t i, dynamics::WheelSpeedsUmS wheels);
  void turnWheels(std::size_t i, double left, double right);

  WorldSettings settings_;
  /// Shared, because the cores refer to it also when the world is moved.
  std::shared_ptr<ProgramLibrary> programs_ = std::make_shared<ProgramLibrary>();
  std::int64_t time_us_ = 0;
  DiskArena disks_;
  SensorModel sensors_;
  std::vector<double>
      next_event_;  ///< Per robot [s of world time]; not in Electronics, for the cache.
  std::vector<Electronics> electronics_;
  std::vector<double> moves_;  ///< Per robot: how long it moves next in a step [s].
  std::shared_ptr<WorkerTeam> team_ = std::make_shared<WorkerTeam>(1);
  std::vector<Scratch> scratch_;  ///< Per thread.
};

}  // namespace lab::sim
