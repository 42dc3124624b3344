/// An experiment, which defines a run completely, as plain data in SI units. docs/experiments.md
/// describes the file format; experiment_file.hpp loads it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/programs/program.hpp"
#include "light/field/drive.hpp"
#include "robot/dynamics/wheel_limits.hpp"

namespace lab {

/// The body of a robot: how it is realised (docs/bodies.md).
enum class Body : std::int8_t {
  kSim,       ///< simulated, on the bus
  kSerial,    ///< real, on a serial line
  kFirmware,  ///< the firmware on a simulated chip, on a simulated line
  kReplay,    ///< a recorded robot, replayed
  kWire,      ///< the firmware's program compiled for the host, on a simulated line
};

/// Whether robot_bridge controls such a robot.
[[nodiscard]] constexpr bool isOnWire(Body body) {
  return body == Body::kSerial || body == Body::kFirmware || body == Body::kWire;
}

/// Whether sim_svc moves such a robot.
[[nodiscard]] constexpr bool isSimulated(Body body) {
  return body == Body::kSim || body == Body::kFirmware || body == Body::kWire;
}

/// The serial number of the electronics of a simulated robot on the wire.
[[nodiscard]] constexpr std::uint32_t simulatedUid(std::int32_t id) {
  return 0x51000000U + static_cast<std::uint32_t>(id);
}

struct StartPose {
  double x = 0;      ///< [m] arena frame
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad]

  bool operator==(const StartPose&) const = default;
};

struct RobotSpec {
  std::int32_t id = 0;
  Body body = Body::kSim;
  std::optional<StartPose> start;  ///< if not given, random without overlap
  std::uint32_t uid = 0;           ///< serial number of a serial robot's electronics
  std::string log;                 ///< log of a replayed robot: path as written in the file
  std::int32_t recorded_id = 0;    ///< id of a replayed robot in that log
  double from = 0;                 ///< [s] time of that log's script at which the replay begins

  bool operator==(const RobotSpec&) const = default;
};

struct LightBand {
  double low = 0;   ///< [1]
  double high = 0;  ///< [1]
  std::string program;

  bool operator==(const LightBand&) const = default;
};

/// Whether a light level lies in the band. Bands are half open, except that full light belongs to a
/// band up to 1.
/// @param widened by this much on both sides, as the band of a running program is by the hysteresis
[[nodiscard]] inline bool contains(const LightBand& band, double light, double widened = 0) {
  const bool full = light >= 1 && band.high >= 1;
  return light >= band.low - widened && (light < band.high + widened || full);
}

enum class LightSensor : std::int8_t { kMean = 0, kFront = 1, kBack = 2 };
enum class ReverseOn : std::int8_t { kNever = 0, kWalls = 1, kAny = 2 };

struct LightTable {
  LightSensor sensor = LightSensor::kMean;
  double hysteresis = 0.02;  ///< [1]
  std::vector<LightBand> bands;

  bool operator==(const LightTable&) const = default;
};

struct Reversal {
  ReverseOn on = ReverseOn::kWalls;
  double distance = 0.40;  ///< [m]
  double speed = 0.10;     ///< [m/s]

  bool operator==(const Reversal&) const = default;
};

/// More robots are simulated in virtual time only: their messages do not fit into one datagram
/// (lcmtypes/README.md).
inline constexpr std::size_t kMostLiveRobots = 250;

/// What simulated robots do at contact.
enum class Contact : std::int8_t { kSlide = 0, kStop = 1 };

/// The hardware of the robots. Errors apply to simulated bodies, and no other part knows them.
struct RobotHardware {
  double diameter = 0.075;        ///< [m] and wheel base d
  double max_wheel_speed = 0.27;  ///< [m/s]
  bool pwm_steps = true;          ///< wheel speeds rounded to 256 levels; false: ideal wheels
  double clock_error = 0.005;     ///< [1] standard deviation of the robots' clock rates
  double wheel_gain_error = 0;    ///< [1] standard deviation of each wheel's gain
  double wheel_base_error = 0;    ///< [1] standard deviation of the distance between the wheels
  double motor_dead_band = 0;     ///< [1] fraction of full duty up to which a wheel stands
  double speed_noise = 0;         ///< [m/sqrt(s)] random forward displacement, off by default
  double turn_noise = 0;          ///< [rad/sqrt(s)] random rotation, off by default
  Contact contact = Contact::kSlide;
  double contact_friction = 0.2;  ///< [1] between rims, and between rim and wall
  double slip_across = 1;         ///< [1] mobility across the wheels, of that along them
  double slip_turn = 1;           ///< [1] mobility of the rim in turning, of that along the wheels
  double sensor_period = 0.02;    ///< [s]
  double light_gain_error = 0;    ///< [1] standard deviation of each light sensor's gain
  double light_noise = 0;         ///< [1] standard deviation of a light reading, of full scale
  double ir_range = 0.05;         ///< [m] from the rim
  double status_rate = 50;        ///< [1/s]
  double lease = 1.0;             ///< [s] robots stop after this time without a command
  double free_run = 0;            ///< [s] replaces the lease if it is longer
  bool resume_after_reboot = false;  ///< a robot on the wire continues after a reboot
  std::string motors;                ///< calibration file of simulated robots: path as in the file

  bool operator==(const RobotHardware&) const = default;
};

[[nodiscard]] inline dynamics::WheelLimits wheelLimits(const RobotHardware& hardware) {
  return {hardware.max_wheel_speed, hardware.diameter};
}

/// The serial lines of real robots.
struct SerialLines {
  std::string ports = "/dev/serial/by-id/*";  ///< patterns with * and ?, separated by spaces
  int baud = 38400;

  bool operator==(const SerialLines&) const = default;
};

/// How a layer depends on what the robots do together: a gate, a control loop or a quorum. The
/// runner applies it once a second, by the analyzer's numbers.
struct CrowdRule {
  std::string gate;     ///< collective number: the layer is shown while it is above or below
  std::string hold;     ///< collective number that the intensity holds at `target`
  bool quorum = false;  ///< only robots whose local density is above or below are followed
  std::string program;  ///< of the number; empty: all robots
  std::optional<double> above;  ///< in the unit of the report, such as cm/s
  std::optional<double> below;
  double target = 0;         ///< in the unit of the report
  double gain = 0;           ///< [1] intensity per unit of the number; negative: light lowers it
  double integral_time = 0;  ///< [s] 0: no integral part
  double lowest = 0;         ///< [1] limits of the intensity
  double highest = 1;        ///< [1]

  [[nodiscard]] bool given() const { return !gate.empty() || !hold.empty() || quorum; }
  bool operator==(const CrowdRule&) const = default;
};

/// A layer with the fields of light_layer_t. light/field/layer.hpp lists the kinds and their keys.
struct LayerSpec {
  std::int8_t kind = 1;
  std::int8_t blend = 0;
  double x = 0;           ///< [m]
  double y = 0;           ///< [m]
  double angle = 0;       ///< [rad]
  double size = 0;        ///< [m]
  double inner = 0;       ///< [m] or [1]
  double softness = 0;    ///< [m]
  double intensity = 0;   ///< [1]
  double intensity2 = 0;  ///< [1]
  std::uint64_t seed = 0;
  double phase = 0;    ///< [rad] or [1]
  std::string image;   ///< path as written in the file, relative to it
  light::Drive drive;  ///< its images are paths as written in the file
  CrowdRule crowd;

  bool operator==(const LayerSpec&) const = default;
};

/// What a virtual sense is (docs/programs.md). The order is that of the names in the file.
enum class SenseKind : std::int8_t {
  kNeighbours,       ///< robots within the radius [1]
  kDensity,          ///< robots within the radius, weighted by 1 - distance / radius [1]
  kMeanHeading,      ///< mean heading of the robots within the radius, relative to the own [rad]
  kNearestDistance,  ///< [cm] to the nearest robot within the radius; the radius without one
  kNearestBearing,   ///< [rad] of the nearest robot within the radius, relative; 0 without one
  kPlaceDistance,    ///< [cm] to a place
  kPlaceBearing,     ///< [rad] of a place, relative to the heading
  kGradient,         ///< of the light at the robot [1/cm]
  kGradientBearing,  ///< direction in which the light grows, relative to the heading [rad]
  kExpression,       ///< an expression of the others
};

/// One number that the host writes for programs.
struct SenseSpec {
  std::int64_t index = 0;  ///< i of sense(i)
  SenseKind kind = SenseKind::kNeighbours;
  double radius = 0.15;  ///< [m]
  double x = 0;          ///< [m] of a place
  double y = 0;          ///< [m]
  std::string value;     ///< the expression

  bool operator==(const SenseSpec&) const = default;
};

/// The numbers that the host computes from the tracker's poses and writes for programs.
struct Senses {
  double rate = 10;  ///< [1/s]
  double delay = 0;  ///< [s] from the exposure of the frame to the sending of the values
  std::vector<SenseSpec> values;

  bool operator==(const Senses&) const = default;
};

enum class Region : std::int8_t { kNone = 0, kCircle = 1, kRectangle = 2 };
enum class Who : std::int8_t { kAny = 0, kAll = 1 };

/// A condition that ends a light step early, or in a StopRule the run: a region, an estimate, a
/// collective number or a number of tumbles.
struct EndCondition {
  Region region = Region::kNone;
  Who who = Who::kAny;  ///< which robots must be in the region, if `robot` is 0
  double x = 0;         ///< [m] centre of the region
  double y = 0;         ///< [m]
  double radius = 0;    ///< [m] of a circle
  double width = 0;     ///< [m] of a rectangle, along x
  double height = 0;    ///< [m]

  std::string estimate;       ///< name in analysis_t, empty: none
  std::string program;        ///< of the estimate
  double relative_error = 0;  ///< [1] standard error over value

  std::string observable;       ///< collective number, empty: none; `program` empty: all robots
  std::optional<double> above;  ///< in the unit of the report, such as cm/s
  std::optional<double> below;
  double over = 10;  ///< [s] its mean over this time is compared

  std::int64_t tumbles = 0;  ///< since the step began; 0: no such condition
  std::int32_t robot = 0;    ///< 0: see `who` for a region; else all robots together

  [[nodiscard]] bool given() const {
    return region != Region::kNone || !estimate.empty() || !observable.empty() || tumbles != 0;
  }
  bool operator==(const EndCondition&) const = default;
};

/// A rule that ends a run early when an estimate is precise enough.
struct StopRule {
  EndCondition until;   ///< a condition on an estimate or a collective number
  double at_least = 0;  ///< [s] time of the script before which the rule is ignored

  bool operator==(const StopRule&) const = default;
};

/// Which rules must hold: all of them or any.
enum class StopOn : std::int8_t { kAll = 0, kAny = 1 };

/// What happens when the condition of a step is not met in time.
enum class IfNot : std::int8_t {
  kNext = 0,  ///< the next step
  kEnd = 1,   ///< the run's end
  kSafe = 2,  ///< the safe light and standing robots, then the run's end
};

struct LightStep {
  double at = 0;    ///< [s] start, from the start of the script; the latest one if !isPlanned()
  double ramp = 0;  ///< [s] cross-fade into this step
  std::string label;
  std::vector<LayerSpec> layers;
  double hold = 0;  ///< [s] longest duration if !isPlanned(); else 0
  EndCondition until;
  IfNot if_not = IfNot::kNext;
  std::string back_to;  ///< label of an earlier step or this one, empty: continue
  std::int64_t times =
      0;  ///< how often the steps from back_to to here are shown, 0 without back_to

  bool operator==(const LightStep&) const = default;
};

struct LightScript {
  double frame_rate = 60;     ///< [1/s]
  double safe_intensity = 0;  ///< [1] shown while no command is valid
  std::vector<LightStep> steps;
  double length = 0;  ///< [s] of one pass if the script repeats; the longest one if !isPlanned()
  bool repeat = false;

  /// Whether all times are known beforehand: no step has a condition or back_to.
  [[nodiscard]] bool isPlanned() const {
    return std::none_of(steps.begin(), steps.end(), [](const LightStep& step) {
      return step.until.given() || !step.back_to.empty();
    });
  }

  bool operator==(const LightScript&) const = default;
};

/// The display name of a projector without window, whose light only sim_svc uses.
inline constexpr const char* kHeadless = "headless";

struct Projector {
  std::string display = kHeadless;  ///< or the name or number of a display
  std::string calibration;  ///< path as written in the file, empty: the arena fills the picture
  std::string
      light_calibration;  ///< path as written in the file, empty: light is proportional to values
  double latency = 0;     ///< [s] from buffer swap to light
  bool overlay = false;
  double sync_patch = 0.015;  ///< [m] side, 0: none
  int width = 1920;           ///< [px] this and all below: of the simulated projector
  int height = 1080;          ///< [px]
  double keystone = 0;        ///< [1]
  double barrel = 0;          ///< [1]
  double offset_x = 0;        ///< [m]
  double offset_y = 0;        ///< [m]
  double gamma = 1;           ///< [1]
  double vignetting = 0;      ///< [1]
  double sheet = 0;           ///< [m] height of a white sheet over the arena; 0: none

  bool operator==(const Projector&) const = default;
};

enum class Tracker : std::int8_t {
  kSimPoses,  ///< sim_svc sends the robots' poses
  kCamera,    ///< tracker_svc measures them with a camera
};

/// What marks robots, animals or particles in the pictures.
enum class Marker : std::int8_t { kCaps, kBlobs, kTags };

/// Brightness of blobs.
enum class BlobTone : std::int8_t { kDark, kBright };

/// Families of AprilTags.
enum class TagFamilyKey : std::int8_t {
  kTag36h11,
  kTag25h9,
  kTag16h5,
  kStandard41h12,
  kStandard52h13
};

/// The source name of the simulated camera, whose frames sim_svc paints.
inline constexpr const char* kSimulatedCamera = "sim";

enum class FilmCodec : std::int8_t {
  kFfv1,     ///< lossless, small
  kFfvhuff,  ///< lossless, a fifth of the work
  kH264,     ///< loses detail
};

/// The film of a run (docs/films.md).
struct FilmSpec {
  bool record = false;
  FilmCodec codec = FilmCodec::kFfv1;
  int crf = 18;         ///< constant rate factor of H.264: 1 best, 51 worst
  double most_GB = 20;  ///< [1e9 bytes] at which the film ends
  int threads = 1;      ///< most that the encoder uses

  bool operator==(const FilmSpec&) const = default;
};

/// What a camera sees of the arena.
struct CameraView {
  double x = 0;       ///< [m] lower left corner
  double y = 0;       ///< [m]
  double width = 0;   ///< [m] 0: up to the border of the arena
  double height = 0;  ///< [m] 0: up to the border of the arena

  bool operator==(const CameraView&) const = default;
};

struct Camera {
  Tracker tracker = Tracker::kSimPoses;
  std::string source = kSimulatedCamera;  ///< which camera (docs/cameras.md)
  double fps = 50;                        ///< [1/s]
  int width = 1280;                       ///< [px]
  int height = 720;                       ///< [px]
  double exposure = 0.01;                 ///< [s]
  double gain = 1;          ///< a factor for the simulated camera, a device's own units
  std::string calibration;  ///< path as in the file, empty: that of the simulated camera
  Marker marker = Marker::kCaps;
  BlobTone blob = BlobTone::kDark;
  double blob_smallest = 0.01;  ///< [m] diameter of a disc with the area of a blob
  double blob_largest = 0.03;   ///< [m]
  TagFamilyKey tag_family = TagFamilyKey::kTag36h11;
  double tag_size = 0.04;       ///< [m] side of a tag, where its black border meets white
  double marker_height = 0.05;  ///< [m] of blobs or tags above the floor
  bool handshake = true;        ///< each robot turns before the script, to be identified
  int debug_port = 0;           ///< of the tracker's debug view on 127.0.0.1, 0: none
  double ambient = 0.03;      ///< [1] room light in the simulated picture, of full projector light
  double position_noise = 0;  ///< [m] standard deviation per axis
  double heading_noise = 0;   ///< [rad] standard deviation
  double delay = 0.02;        ///< [s] from exposure to message
  double dropout = 0;         ///< [1] probability that one robot is missing in one frame
  double frame_loss = 0;      ///< [1] probability that a whole frame is missing
  std::string frames;         ///< times of recorded frames: path as in the file, empty: by fps
  FilmSpec film;
  // Only of one of several cameras (CameraSpec):
  std::string name;
  CameraView view;
  double clock_error = 0;  ///< [s] the simulated camera's time stamps are too late by this

  bool operator==(const Camera&) const = default;
};

/// One of several cameras with overlapping views. What it does not set is that of Camera.
struct CameraSpec {
  std::string name;
  std::string source;       ///< empty: Camera::source
  std::string calibration;  ///< path as in the file, empty: that of the simulated camera
  int width = 0;            ///< [px] 0: Camera::width
  int height = 0;           ///< [px] 0: Camera::height
  CameraView view;          ///< also whose corners its calibration needs
  double clock_error = 0;   ///< [s] the simulated camera's time stamps are too late by this

  bool operator==(const CameraSpec&) const = default;
};

/// Name and number of tags of a family.
struct TagFamilyEntry {
  const char* name = "";
  int tags = 0;
};
[[nodiscard]] constexpr TagFamilyEntry entryOf(TagFamilyKey family) {
  switch (family) {
    case TagFamilyKey::kTag25h9:
      return {"tag25h9", 35};
    case TagFamilyKey::kTag16h5:
      return {"tag16h5", 30};
    case TagFamilyKey::kStandard41h12:
      return {"tagStandard41h12", 2115};
    case TagFamilyKey::kStandard52h13:
      return {"tagStandard52h13", 48714};
    case TagFamilyKey::kTag36h11:
      break;
  }
  return {"tag36h11", 587};
}

/// Whether robots must turn before the script so that the tracker can tell them apart.
[[nodiscard]] inline bool needsHandshake(const Camera& camera) {
  return camera.tracker == Tracker::kCamera && camera.marker == Marker::kCaps && camera.handshake;
}

/// Whether tracker_svc reads the simulated camera.
[[nodiscard]] inline bool isPainted(const Camera& camera) {
  return camera.tracker == Tracker::kCamera && camera.source == kSimulatedCamera;
}

/// Whether tracker_svc keeps a film of the run.
[[nodiscard]] inline bool isFilmed(const Camera& camera) {
  return camera.tracker == Tracker::kCamera && camera.film.record;
}

/// A named part of the arena, for times and fluxes of robots.
struct RegionSpec {
  std::string name;
  Region shape = Region::kRectangle;
  double x = 0;       ///< [m] centre
  double y = 0;       ///< [m]
  double radius = 0;  ///< [m] of a circle
  double width = 0;   ///< [m] of a rectangle, along x
  double height = 0;  ///< [m]

  bool operator==(const RegionSpec&) const = default;
};

struct AnalysisOptions {
  double max_lag = 100;             ///< [s]
  double results_every = 0;         ///< [s] between online results; 0: by who reads them
  double cluster_distance = 0;      ///< [m] between centres; 0: 1.1 diameters
  std::vector<RegionSpec> regions;  ///< a robot is in the first one that holds its centre
  int twins = 0;                    ///< simulated twins at the end of the run; 0: none

  bool operator==(const AnalysisOptions&) const = default;
};

struct Network {
  int port = 0;  ///< of the LCM bus; 0: a free one
  int ttl = 0;   ///< 0: this machine only

  bool operator==(const Network&) const = default;
};

/// The ROS 2 side of dds_gateway (docs/ros2.md).
struct Gateway {
  bool ros = false;                ///< whether ROS 2 can observe the lab
  int domain = 0;                  ///< ROS_DOMAIN_ID
  std::string name = "lab";        ///< first part of every topic
  std::string mapping;             ///< path as in the file, empty: the built-in mapping
  std::string address;             ///< of the interface to use, empty: this machine only
  std::vector<std::string> peers;  ///< addresses of hosts that multicast does not reach
  std::string configuration;   ///< path of a Cyclone DDS XML file that replaces the built-in one
  std::string security;        ///< folder of certificates, as in the file; empty: none
  bool commands = false;       ///< whether ROS 2 may drive robots and light
  bool load_programs = false;  ///< whether it may send texts of programs
  bool unsecured_commands = false;  ///< accept commands from other hosts without DDS Security
  std::vector<std::int32_t> command_robots;  ///< robots that it may drive, empty: all
  double command_timeout = 0.4;  ///< [s] a driven robot stands after this time without a command

  bool operator==(const Gateway&) const = default;
};

/// How the buses of several hosts are joined (docs/hosts.md).
enum class JoinBy : std::int8_t {
  kDds,        ///< a gateway on each host, over reliable DDS
  kMulticast,  ///< LCM itself reaches all hosts (network.ttl)
};

struct Link {
  JoinBy join = JoinBy::kDds;
  int domain = 77;                  ///< of DDS; different from that of ROS 2
  std::string address;              ///< of this host as seen from the others, empty: the one of ssh
  std::string security;             ///< folder of certificates, as in the file; empty: none
  bool unsecured = false;           ///< forward commands without DDS Security
  double max_clock_offset = 0.005;  ///< [s] a host with a larger offset is refused
  double patience = 60;             ///< [s] how long a run waits for a silent host

  bool operator==(const Link&) const = default;
};

/// Another computer that runs services.
struct HostSpec {
  std::string name;      ///< as used in services
  std::string ssh;       ///< argument of ssh, empty: the name
  std::string address;   ///< as seen from this host, empty: the one of ssh
  std::string programs;  ///< folder of the programs there, empty: its PATH

  bool operator==(const HostSpec&) const = default;
};

/// The host on which a service runs.
struct ServicePlacement {
  std::string service;
  std::string host;  ///< name of a HostSpec or argument of ssh, empty: this machine

  bool operator==(const ServicePlacement&) const = default;
};

/// The page in a browser (docs/dashboard.md).
struct Dashboard {
  std::string address;                  ///< to listen on, empty: this machine only
  int port = 8480;                      ///< the first port that is tried
  bool control_from_elsewhere = false;  ///< false: the buttons work on this machine only

  bool operator==(const Dashboard&) const = default;
};

/// Simulated faults of a network.
struct Faults {
  double message_loss = 0;  ///< [1] probability, per message and receiver, in virtual time

  bool operator==(const Faults&) const = default;
};

struct Experiment {
  int fileversion = 1;
  std::string name;
  std::string description;
  std::uint64_t seed = 1;
  double duration = 0;         ///< [s]
  double arena_width = 1.20;   ///< [m] along x
  double arena_height = 0.90;  ///< [m] along y
  Network network;
  Gateway gateway;
  Link link;
  Dashboard dashboard;
  std::map<std::string, HostSpec> hosts;
  std::map<std::string, ServicePlacement> services;  ///< services with an explicit host
  RobotHardware hardware;
  SerialLines serial;
  std::vector<RobotSpec> robots;  ///< sorted by id
  std::map<std::string, Program> programs;
  Senses senses;
  LightTable light_table;
  Reversal reversal;
  LightScript light;
  std::vector<StopRule> stop_when;  ///< empty: the run does not end early
  StopOn stop_on = StopOn::kAll;
  Projector projector;
  Camera camera;
  std::vector<CameraSpec> cameras;  ///< empty: only `camera`
  AnalysisOptions analysis;
  Faults faults;

  bool operator==(const Experiment&) const = default;
};

/// All cameras of an experiment: those of [[cameras]] with what they inherit, or the only one.
[[nodiscard]] std::vector<Camera> camerasOf(const Experiment& experiment);

}  // namespace lab
