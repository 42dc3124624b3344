#include "common/experiment_keys.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <utility>

#include "dynamics/light_table.hpp"
#include "light/layer.hpp"

namespace lab::keys {
namespace {

using light::Blend;
using light::LayerKind;

template <typename Enum>
Choice choiceOf(const char* name, Enum value) {
  return {name, static_cast<int>(value)};
}

const std::array<Choice, 6> kModels = {
    {choiceOf("abp", Model::kAbp), choiceOf("noisy_abp", Model::kNoisyAbp),
     choiceOf("bp", Model::kBp), choiceOf("rtp", Model::kRtp), choiceOf("stand", Model::kNone),
     choiceOf("wheels", Model::kWheels)}};
const std::array<Choice, 5> kBodies = {
    {choiceOf("sim", Body::kSim), choiceOf("wire", Body::kWire),
     choiceOf("firmware", Body::kFirmware), choiceOf("serial", Body::kSerial),
     choiceOf("replay", Body::kReplay)}};
const std::array<Choice, 3> kSensors = {{choiceOf("mean", LightSensor::kMean),
                                         choiceOf("front", LightSensor::kFront),
                                         choiceOf("back", LightSensor::kBack)}};
const std::array<Choice, 3> kReverseOn = {{choiceOf("never", ReverseOn::kNever),
                                           choiceOf("walls", ReverseOn::kWalls),
                                           choiceOf("any", ReverseOn::kAny)}};
const std::array<Choice, 2> kTrackers = {
    {choiceOf("sim", Tracker::kSimPoses), choiceOf("camera", Tracker::kCamera)}};
const std::array<Choice, 9> kKinds = {
    {choiceOf("uniform", LayerKind::kUniform), choiceOf("half_plane", LayerKind::kHalfPlane),
     choiceOf("disk", LayerKind::kDisk), choiceOf("ring", LayerKind::kRing),
     choiceOf("linear_gradient", LayerKind::kLinearGradient),
     choiceOf("radial_gradient", LayerKind::kRadialGradient),
     choiceOf("stripes", LayerKind::kStripes), choiceOf("checker", LayerKind::kChecker),
     choiceOf("image", LayerKind::kImage)}};
const std::array<Choice, 5> kBlends = {
    {choiceOf("over", Blend::kOver), choiceOf("add", Blend::kAdd),
     choiceOf("multiply", Blend::kMultiply), choiceOf("max", Blend::kMax),
     choiceOf("min", Blend::kMin)}};

const Range kShare{0, 1};
const Range kPlace{-1000, 1000};
const Range kLength{0.1, 1000};
const Range kAngle{-3600, 3600};
const Range kSpeed{-500, 500};
const Range kHold{0.001, 3600};
constexpr double kLongestFreeRun = 86400;

template <typename Enum>
void enumerate(KeyVisitor& visitor, const Key& key, std::span<const Choice> choices, Enum& field) {
  int value = static_cast<int>(field);
  visitor.choice(key, choices, value);
  if (value != kUndecided) field = static_cast<Enum>(value);
}

template <typename Element, typename Keys>
void visitList(KeyVisitor& visitor, const Key& key, const ListRule& rule,
               std::vector<Element>& elements, const Keys& keys) {
  visitor.list(
      key, rule, elements.size(), [&](std::size_t size) { elements.assign(size, Element{}); },
      [&](std::size_t index) { keys(elements[index]); });
}

/// Keys that only some choices of the key before them have.
class Selector {
 public:
  template <typename Enum>
  Selector(KeyVisitor& visitor, const Key& key, std::span<const Choice> choices, Enum& field)
      : name_(key.name), choices_(choices), current_(static_cast<int>(field)) {
    visitor.choice(key, choices, current_);
    if (current_ != kUndecided) field = static_cast<Enum>(current_);
  }

  template <typename Enum>
  [[nodiscard]] Key only(std::initializer_list<Enum> values, Key key) const {
    key.applies = current_ == kUndecided ? Applies::kUndecided : Applies::kNo;
    for (const Enum value : values) {
      if (static_cast<int>(value) == current_) key.applies = Applies::kYes;
      key.condition += key.condition.empty() ? name_ + " = " : " or ";
      key.condition += '"' + nameOf(static_cast<int>(value)) + '"';
    }
    return key;
  }

 private:
  [[nodiscard]] std::string nameOf(int value) const {
    return std::ranges::find(choices_, value, &Choice::value)->name;
  }

  std::string name_;
  std::span<const Choice> choices_;
  int current_;
};

void visitNetwork(KeyVisitor& v, Network& network) {
  std::int64_t port = network.port;
  std::int64_t ttl = network.ttl;
  v.integer({"port", "UDP port of the LCM bus, 0: a free one"}, 0, 65535, port);
  v.integer({"ttl", "how many routers a message may pass, 0: it stays on this machine"}, 0, 255,
            ttl);
  network.port = static_cast<int>(port);
  network.ttl = static_cast<int>(ttl);
}

void visitHardware(KeyVisitor& v, RobotHardware& robot) {
  v.number({"diameter_cm", "diameter, which is also the distance d between the wheels"}, {1, 50},
           robot.diameter);
  v.number({"max_wheel_speed_cm_s", "fastest speed of a wheel"}, {0.1, 500}, robot.max_wheel_speed);
  v.flag({"pwm_steps",
          "wheel speeds come in 256 steps, rounded to the nearest, as from the "
          "robot's PWM; false: ideal wheels"},
         robot.pwm_steps);
  v.number({"clock_error_percent", "standard deviation of the rates of the robots' clocks"}, {0, 5},
           robot.clock_error);
  v.number({"wheel_gain_error_percent",
            "standard deviation of the wheels' gains, drawn once for "
            "each wheel; turns straight runs into circles"},
           {0, 20}, robot.wheel_gain_error);
  v.number({"wheel_base_error_percent",
            "standard deviation of the distances between the wheels"},
           {0, 20}, robot.wheel_base_error);
  v.number({"motor_dead_band_percent", "of full duty, up to which a wheel does not turn"}, {0, 40},
           robot.motor_dead_band);
  v.number({"speed_noise_cm_sqrt_s",
            "random forward motion: its variance grows by the square of "
            "this every second"},
           {0, 10}, robot.speed_noise);
  v.number({"turn_noise_deg_sqrt_s", "random turning, likewise"}, {0, 90}, robot.turn_noise);
  v.number({"sensor_period_ms", "time between two readings of the robot's sensors"},
           {.low = 1, .high = 1000, .whole = true}, robot.sensor_period);
  v.number({"ir_range_cm", "how far from the rim the infrared sensors see"}, {0, 100},
           robot.ir_range);
  v.number({"status_rate_hz", "ROBOT_STATUS messages a second"}, {1, 200}, robot.status_rate);
  v.number({"lease_s",
            "a robot stops when it has heard no command for this long; commands come "
            "every 0.2 s"},
           {0.4, 60}, robot.lease);
  v.number({"free_run_s",
            "a robot goes on for this long without hearing a command; 0: lease_s is all it has"},
           {0, kLongestFreeRun}, robot.free_run);
  v.flag({"resume_after_reboot",
          "a robot on the wire that reboots during a run goes on by itself; false: it stands "
          "until the run ends"},
         robot.resume_after_reboot);
  v.text({"motors",
          "what simulated robots hold of their motors: calibration/motors.toml of a run of lab "
          "calibrate motors, beside the experiment file"},
         {.most = 400}, robot.motors);
}

void visitSerial(KeyVisitor& v, SerialLines& serial) {
  std::int64_t baud = serial.baud;
  v.text({"ports",
          "devices that may be robots, with * and ?, separated by spaces; opening one resets the "
          "board on it"},
         {.most = 1000}, serial.ports);
  v.integer({"baud", "speed of the lines, as the firmware was built"}, 9600, 500000, baud);
  serial.baud = static_cast<int>(baud);
}

void visitRobot(KeyVisitor& v, RobotEntry& robot) {
  v.integer({"id", "the robot's number; with count, the first one's", Need::kRequired}, 1,
            kLargestId, robot.id);
  v.integer({"count", "this many robots, with consecutive ids"}, 1, kMostRobots, robot.count);
  const Selector body(v,
                      {"body",
                       "what the robot is (bodies.md): sim and wire simulated, firmware the real "
                       "program on a simulated chip, serial real, replay a recorded robot"},
                      kBodies, robot.body);
  v.optionalNumber({.name = "x_cm",
                    .meaning = "where the robot starts: x_cm, y_cm and theta_deg together or none "
                               "of them, and only without count",
                    .default_text = "random"},
                   kPlace, robot.x);
  v.optionalNumber({.name = "y_cm", .meaning = "see x_cm", .default_text = "random"}, kPlace,
                   robot.y);
  v.optionalNumber({.name = "theta_deg",
                    .meaning = "heading, counter-clockwise from x; see x_cm",
                    .default_text = "random"},
                   kAngle, robot.theta);
  v.integer(body.only({Body::kSerial},
                      {"uid", "number of the electronics, as robot_bridge --list shows it",
                       Need::kRequired}),
            1, 0xFFFFFFFFLL, robot.uid);
  v.text(body.only({Body::kReplay},
                   {"log", "log, or folder of a run, beside the experiment file", Need::kRequired}),
         {.most = 400}, robot.log);
  v.integer(body.only({Body::kReplay}, {.name = "recorded_id",
                                        .meaning = "the robot in that log; 0: the same id"}),
            0, kLargestId, robot.recorded_id);
  v.number(body.only({Body::kReplay}, {"from_s", "where in that log's script the replay begins"}),
           {0, kLongestRun}, robot.from);
}

void visitProgram(KeyVisitor& v, ProgramSpec& program) {
  const Selector model(v, {"model", "the kind of motion", Need::kRequired}, kModels, program.model);
  const auto needed = [](const char* name, const char* meaning) {
    return Key{name, meaning, Need::kRequired};
  };
  v.number(model.only({Model::kAbp, Model::kRtp}, needed("v_cm_s", "speed; of a run (rtp)")),
           kSpeed, program.v);
  v.number(model.only({Model::kNoisyAbp}, needed("va_cm_s", "mean speed of each wheel")), kSpeed,
           program.va);
  v.number(model.only({Model::kNoisyAbp, Model::kBp},
                      needed("V_cm_s", "half width of the wheels' uniform speed noise")),
           {0, 500}, program.V);
  v.number(model.only({Model::kAbp, Model::kNoisyAbp, Model::kBp},
                      needed("epsilon_s",
                             "for how long one draw is held; whole milliseconds, at "
                             "least robot.sensor_period_ms")),
           kHold, program.epsilon);
  v.number(
      model.only({Model::kAbp}, needed("eta_rad_s", "half width of the uniform rate of turning")),
      {0, 1000}, program.eta);
  v.number(model.only({Model::kRtp}, needed("gamma_per_s", "rate of tumbling: 1 / mean run time")),
           {0.01, 1000}, program.gamma);
  v.number(model.only({Model::kRtp}, needed("tau_t_s",
                                            "duration of a tumble; whole milliseconds, "
                                            "at least robot.sensor_period_ms")),
           kHold, program.tau_t);
  v.number(model.only({Model::kWheels}, needed("left_cm_s", "speed of the left wheel")), kSpeed,
           program.wheel_left);
  v.number(model.only({Model::kWheels}, needed("right_cm_s", "speed of the right wheel")), kSpeed,
           program.wheel_right);
}

void visitLightTable(KeyVisitor& v, LightTable& table) {
  enumerate(v, {"sensor", "which of the robot's two light sensors the bands are compared with"},
            kSensors, table.sensor);
  v.number({"hysteresis", "a band is kept until the light is outside it by more than this"},
           {0, 0.5}, table.hysteresis);
  visitList(v,
            {"bands",
             "which light selects which program; in light outside every band a robot "
             "stands"},
            {.fewest = 0, .most = dynamics::kSlots, .in_line = true}, table.bands,
            [&](LightBand& band) {
              v.interval({"light",
                          "[low, high]: the band holds low <= light < high, and full light "
                          "where high is 1",
                          Need::kRequired},
                         kShare, band.low, band.high);
              v.text({"program", "name of the program", Need::kRequired},
                     {.most = 32, .bare = true}, band.program);
            });
}

void visitReversal(KeyVisitor& v, Reversal& reversal) {
  enumerate(v, {"on", "what a robot that comes too near turns back from; any: walls and robots"},
            kReverseOn, reversal.on);
  v.number({"distance_cm", "how far it drives back (appendix B: about 40 cm)"}, {1, 400},
           reversal.distance);
  v.number({"speed_cm_s", "how fast"}, {0.1, 500}, reversal.speed);
}

// Lengths and places go to the fields of the same layer that light/layer.hpp lists.
void visitLayer(KeyVisitor& v, LayerEntry& entry) {
  using enum LayerKind;
  LayerSpec& layer = entry.layer;
  auto layer_kind = static_cast<LayerKind>(layer.kind);
  auto blend = static_cast<Blend>(layer.blend);
  const Selector kind(v, {"kind", "what is painted", Need::kRequired}, kKinds, layer_kind);
  const auto placed = {kHalfPlane,      kDisk,    kRing,    kLinearGradient,
                       kRadialGradient, kStripes, kChecker, kImage};
  enumerate(v, {"blend", "how it changes what the layers before it painted"}, kBlends, blend);
  layer.kind = static_cast<std::int8_t>(layer_kind);
  layer.blend = static_cast<std::int8_t>(blend);
  const Key file{"file",
                 "image file, beside the experiment file; grey 0 gives intensity2, white "
                 "intensity",
                 Need::kRequired};
  v.text(kind.only({kImage}, file), {.most = 200}, layer.image);
  const std::string middle = "middle of the arena";
  v.optionalNumber(kind.only(placed, {.name = "x_cm",
                                      .meaning = "centre, or a point on the edge of a half plane",
                                      .default_text = middle}),
                   kPlace, entry.x);
  v.optionalNumber(
      kind.only(placed, {.name = "y_cm", .meaning = "see x_cm", .default_text = middle}), kPlace,
      entry.y);
  v.number(kind.only({kHalfPlane, kLinearGradient, kStripes, kChecker, kImage},
                     {"angle_deg",
                      "direction, counter-clockwise from x: towards the lit side, up "
                      "the gradient, across the stripes, of the image's lower edge"}),
           kAngle, layer.angle);
  v.number(
      kind.only({kDisk, kRing, kRadialGradient}, {"radius_cm", "outer radius", Need::kRequired}),
      kLength, layer.size);
  v.number(
      kind.only({kLinearGradient}, {"length_cm",
                                    "over which intensity turns into intensity2, half of it on "
                                    "either side of x_cm, y_cm",
                                    Need::kRequired}),
      kLength, layer.size);
  v.number(kind.only({kStripes, kChecker},
                     {"period_cm", "of the stripes; side of a checker's squares", Need::kRequired}),
           kLength, layer.size);
  v.number(kind.only({kImage}, {"width_cm", "of the image", Need::kRequired}), kLength, layer.size);
  v.number(kind.only({kRing, kRadialGradient},
                     {"inner_radius_cm", "inner radius; up to it a radial gradient has intensity"}),
           {0, 1000}, layer.inner);
  v.number(
      kind.only({kStripes}, {"share", "of a period that has intensity; the rest has intensity2",
                             Need::kRequired}),
      {.low = 0, .high = 1, .above_low = true, .below_high = true}, layer.inner);
  v.number(kind.only({kImage}, {"height_cm", "of the image", Need::kRequired}), kLength,
           layer.inner);
  v.number(kind.only({kHalfPlane, kDisk, kRing, kStripes, kChecker, kImage},
                     {"softness_cm", "width of the edges"}),
           {0, 1000}, layer.softness);
  v.number({"intensity", "0 dark .. 1 projector white", Need::kRequired}, kShare, layer.intensity);
  v.number(kind.only({kLinearGradient, kRadialGradient, kStripes, kChecker, kImage},
                     {"intensity2", "the other end or the other part"}),
           kShare, layer.intensity2);
}

void visitStep(KeyVisitor& v, StepEntry& step) {
  v.text({.name = "label", .meaning = "for reports", .default_text = "step 1, step 2, ..."},
         {.most = 60}, step.label);
  v.optionalNumber({.name = "at_s",
                    .meaning = "when the step begins; the first at 0, the others in rising order",
                    .default_text = "needed where there is no hold_s"},
                   {0, kLongestRun}, step.at);
  v.optionalNumber({"hold_s", "how long the step is shown; all steps have at_s or all have hold_s",
                    Need::kShorthand, "-"},
                   {.low = 0, .high = kLongestRun, .above_low = true}, step.hold);
  v.number({"ramp_s", "cross-fade from the step before, as long at most as the step"}, {0, 3600},
           step.ramp);
  visitList(v, {"layers", "painted one upon the other, from the dark", Need::kRequired},
            {.fewest = 1, .most = light::kMostLayers, .in_line = true}, step.layers,
            [&](LayerEntry& layer) { visitLayer(v, layer); });
}

void visitLight(KeyVisitor& v, ExperimentForm& form) {
  LightScript& light = form.common.light;
  v.number({"frame_rate_hz", "frames a second of the projector"}, {1, 500}, light.frame_rate);
  v.number({"safe_intensity", "shown everywhere when nobody commands the light"}, kShare,
           light.safe_intensity);
  v.flag({"repeat", "the steps begin again when the last one has ended"}, light.repeat);
  v.optionalNumber({.name = "length_s",
                    .meaning = "when the last step ends, only with repeat; the sum where steps "
                               "have hold_s",
                    .default_text = "-"},
                   {.low = 0, .high = kLongestRun, .above_low = true}, form.light_length);
  visitList(v, {"steps", "what is shown when"}, {.fewest = 0, .most = 1000}, form.light_steps,
            [&](StepEntry& step) { visitStep(v, step); });
}

void visitCamera(KeyVisitor& v, Camera& camera) {
  const Selector tracker(
      v,
      {"tracker",
       "who tells where the robots are; sim: the simulator, with the errors below; camera: "
       "tracker_svc, from pictures"},
      kTrackers, camera.tracker);
  const auto painted = [&](Key key) { return tracker.only({Tracker::kCamera}, std::move(key)); };
  const auto modelled = [&](Key key) { return tracker.only({Tracker::kSimPoses}, std::move(key)); };
  v.text(painted({"camera", "sim: the one that sim_svc paints; else a device, a movie or an "
                               "address (docs/cameras.md)"}),
         {.most = 400}, camera.source);
  v.number({"fps", "frames a second"}, {1, 500}, camera.fps);
  std::int64_t width = camera.width;
  std::int64_t height = camera.height;
  v.integer(painted({"width_px", "of the pictures"}), 160, 8192, width);
  v.integer(painted({"height_px", "of the pictures"}), 120, 8192, height);
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  v.number(painted({"exposure_ms", "of a frame"}), {.low = 0, .high = 1000, .above_low = true},
           camera.exposure);
  v.number(painted({"gain", "of the simulated camera a factor, of a device in its own units"}),
           {0, 1e6}, camera.gain);
  v.text(painted({.name = "calibration",
                     .meaning = "camera.json of lab calibrate camera; the simulated camera's own "
                                "where empty",
                     .default_text = "empty"}),
         {.most = 400}, camera.calibration);
  v.flag(painted({"handshake", "before the script each robot turns for a moment, so that the "
                                  "tracker knows which cap it is"}),
         camera.handshake);
  std::int64_t port = camera.debug_port;
  v.integer(painted({"debug_port", "of the tracker's debug view on 127.0.0.1, 0: none"}), 0,
            65535, port);
  camera.debug_port = static_cast<int>(port);
  v.number(painted({"ambient", "room light in the simulated picture, of the projector's white"}),
           kShare, camera.ambient);
  v.number(modelled({"position_noise_cm", "standard deviation of x and of y"}), {0, 5},
           camera.position_noise);
  v.number(modelled({"heading_noise_deg", "standard deviation of the heading"}), {0, 90},
           camera.heading_noise);
  v.number({"delay_ms", "from the exposure to the message, or to the picture where one is painted"},
           {0, 5000}, camera.delay);
  v.number(modelled({"dropout", "chance that one robot is missing in one frame"}),
           {.low = 0, .high = 1, .below_high = true}, camera.dropout);
  v.number({"frame_loss", "chance that a whole simulated frame is missing"},
           {.low = 0, .high = 1, .below_high = true}, camera.frame_loss);
}

void visitTop(KeyVisitor& v, ExperimentForm& form) {
  Experiment& e = form.common;
  std::int64_t version = e.fileversion;
  std::int64_t seed = static_cast<std::int64_t>(e.seed);
  v.integer({"fileversion", "version of this format", Need::kRequired}, kFileVersion, kFileVersion,
            version);
  v.text({"name", "of the run and of its folder", Need::kRequired}, {.most = 64, .as_folder = true},
         e.name);
  v.text({"description", "for people"}, {.most = 4000}, e.description);
  v.integer({"seed", "all random numbers derive from it"}, 0,
            std::numeric_limits<std::int64_t>::max(), seed);
  v.number({"duration_s", "length of the run, at most ten days", Need::kRequired},
           {0.001, kLongestRun}, e.duration);
  v.text({"program",
          "shorthand for a light_table with one band over all light, and for a uniform "
          "light of 0.5 where [light] has no steps",
          Need::kShorthand, "-"},
         {.most = 32, .bare = true}, form.program);
  e.fileversion = static_cast<int>(version);
  e.seed = static_cast<std::uint64_t>(seed);
}

}  // namespace

void visitKeys(KeyVisitor& v, ExperimentForm& form) {
  Experiment& e = form.common;
  visitTop(v, form);
  v.table({"network", "The message bus"}, [&] { visitNetwork(v, e.network); });
  v.table({"arena",
           "The arena: its corner is the origin, x runs along the width, y along the "
           "height"},
          [&] {
            v.number({"width_cm", "along x"}, {10, 1000}, e.arena_width);
            v.number({"height_cm", "along y"}, {10, 1000}, e.arena_height);
          });
  v.table({"robot",
           "The robots' hardware, the same for all. Errors are what a simulated robot has "
           "and does not know"},
          [&] { visitHardware(v, e.hardware); });
  v.table({"serial", "The lines to real robots (body = \"serial\")"},
          [&] { visitSerial(v, e.serial); });
  visitList(v, {"robots", "The robots that take part", Need::kRequired},
            {.fewest = 1, .most = kMostRobots}, form.robots,
            [&](RobotEntry& robot) { visitRobot(v, robot); });
  std::vector<std::string> names;
  for (const auto& [name, program] : e.programs) names.push_back(name);
  v.namedTables({"programs", "What robots can do; NAME is yours", Need::kRequired},
                {.most = 32, .bare = true}, {.fewest = 1, .most = 100}, names,
                [&](const std::string& name) {
                  ProgramSpec& program = e.programs[name];
                  program.name = name;
                  visitProgram(v, program);
                });
  v.table({"light_table", "Which light selects which program"},
          [&] { visitLightTable(v, e.light_table); });
  v.table({"reversal", "Turning back from obstacles (appendix B of the paper)"},
          [&] { visitReversal(v, e.reversal); });
  v.table({"light", "The light script"}, [&] { visitLight(v, form); });
  v.table({"camera", "Camera and tracker"}, [&] { visitCamera(v, e.camera); });
  v.table({"analysis", "The analyzer"}, [&] {
    v.number({"max_lag_s", "longest lag of the curves"}, {0.1, 3600}, e.analysis.max_lag);
  });
  v.table({"faults", "For practising with what a network does"}, [&] {
    v.number({"message_loss", "chance that a message does not reach a listener, in virtual time"},
             {.low = 0, .high = 1, .below_high = true}, e.faults.message_loss);
  });
}

}  // namespace lab::keys
