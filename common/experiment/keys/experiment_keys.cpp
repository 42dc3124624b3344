#include "common/experiment/keys/experiment_keys.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/experiment/keys/film_keys.hpp"
#include "common/experiment/keys/key_helpers.hpp"
#include "common/experiment/keys/light_keys.hpp"
#include "common/experiment/keys/network_keys.hpp"
#include "common/experiment/keys/sweep_keys.hpp"
#include "common/programs/program.hpp"
#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/light_table.hpp"

namespace lab::keys {
namespace {

constexpr double kLargestArena = 3000;  // [cm], room for kMostRobots; see also checkArena()

const std::array<Choice, 5> kBodies = {{choiceOf("sim", Body::kSim), choiceOf("wire", Body::kWire),
                                        choiceOf("firmware", Body::kFirmware),
                                        choiceOf("serial", Body::kSerial),
                                        choiceOf("replay", Body::kReplay)}};
const std::array<Choice, 3> kSensors = {{choiceOf("mean", LightSensor::kMean),
                                         choiceOf("front", LightSensor::kFront),
                                         choiceOf("back", LightSensor::kBack)}};
const std::array<Choice, 10> kSenseKinds = {
    {choiceOf("neighbours", SenseKind::kNeighbours), choiceOf("density", SenseKind::kDensity),
     choiceOf("mean_heading", SenseKind::kMeanHeading),
     choiceOf("nearest_distance", SenseKind::kNearestDistance),
     choiceOf("nearest_bearing", SenseKind::kNearestBearing),
     choiceOf("place_distance", SenseKind::kPlaceDistance),
     choiceOf("place_bearing", SenseKind::kPlaceBearing),
     choiceOf("gradient", SenseKind::kGradient),
     choiceOf("gradient_bearing", SenseKind::kGradientBearing),
     choiceOf("expression", SenseKind::kExpression)}};
const std::array<Choice, 3> kReverseOn = {{choiceOf("never", ReverseOn::kNever),
                                           choiceOf("walls", ReverseOn::kWalls),
                                           choiceOf("any", ReverseOn::kAny)}};
const std::array<Choice, 2> kContacts = {
    {choiceOf("slide", Contact::kSlide), choiceOf("stop", Contact::kStop)}};
const std::array<Choice, 2> kShapes = {
    {choiceOf("circle", Region::kCircle), choiceOf("rectangle", Region::kRectangle)}};
const std::array<Choice, 2> kTrackers = {
    {choiceOf("sim", Tracker::kSimPoses), choiceOf("camera", Tracker::kCamera)}};
const std::array<Choice, 3> kMarkers = {{choiceOf("caps", Marker::kCaps),
                                         choiceOf("blobs", Marker::kBlobs),
                                         choiceOf("tags", Marker::kTags)}};
const std::array<Choice, 2> kBlobTones = {
    {choiceOf("dark", BlobTone::kDark), choiceOf("bright", BlobTone::kBright)}};
const std::array<Choice, 5> kTagFamilies = {
    {choiceOf(entryOf(TagFamilyKey::kTag36h11).name, TagFamilyKey::kTag36h11),
     choiceOf(entryOf(TagFamilyKey::kTag25h9).name, TagFamilyKey::kTag25h9),
     choiceOf(entryOf(TagFamilyKey::kTag16h5).name, TagFamilyKey::kTag16h5),
     choiceOf(entryOf(TagFamilyKey::kStandard41h12).name, TagFamilyKey::kStandard41h12),
     choiceOf(entryOf(TagFamilyKey::kStandard52h13).name, TagFamilyKey::kStandard52h13)}};

void visitHardware(KeyVisitor& v, RobotHardware& robot) {
  v.number({"diameter_cm", "diameter, which is also the distance d between the wheels"}, {1, 50},
           robot.diameter);
  v.number({"max_wheel_speed_cm_s", "highest speed of a wheel"}, {0.1, 500}, robot.max_wheel_speed);
  v.flag({"pwm_steps",
          "wheel speeds are rounded to the 256 levels of the robot's PWM; false: ideal wheels"},
         robot.pwm_steps);
  v.number({"clock_error_percent", "standard deviation of the rates of the robots' clocks"}, {0, 5},
           robot.clock_error);
  v.number({"wheel_gain_error_percent",
            "standard deviation of the wheels' gains, drawn once for "
            "each wheel; turns straight runs into circles"},
           {0, 20}, robot.wheel_gain_error);
  v.number({"wheel_base_error_percent", "standard deviation of the distances between the wheels"},
           {0, 20}, robot.wheel_base_error);
  v.number({"motor_dead_band_percent", "fraction of full duty up to which a wheel does not turn"},
           {0, 40}, robot.motor_dead_band);
  v.number({"speed_noise_cm_sqrt_s",
            "random forward motion: its variance grows by the square of this per second"},
           {0, 10}, robot.speed_noise);
  v.number({"turn_noise_deg_sqrt_s",
            "random rotation: its variance grows by the square of this per second"},
           {0, 90}, robot.turn_noise);
  enumerate(v,
            {"contact",
             "what simulated robots do at contact (bodies.md); slide: they slide along each other "
             "and along walls, push and turn each other; stop: they stop, as in earlier versions"},
            kContacts, robot.contact);
  v.number({"contact_friction", "friction coefficient between rims, and between rim and wall"},
           {0, 2}, robot.contact_friction);
  v.number({"slip_across",
            "how easily a force moves a robot across its wheels, as a multiple of how easily it "
            "does along them"},
           {0.05, 20}, robot.slip_across);
  v.number(
      {"slip_turn",
       "how easily a force along the rim turns a robot: speed of the rim, as a multiple of the "
       "speed that the force gives along the wheels"},
      {0, 20}, robot.slip_turn);
  v.number({"sensor_period_ms", "time between two readings of the robot's sensors"},
           {.low = 1, .high = 1000, .whole = true}, robot.sensor_period);
  v.number({"light_gain_error_percent",
            "standard deviation of the gains of the light sensors, drawn once for each"},
           {0, 30}, robot.light_gain_error);
  v.number(
      {"light_noise_percent", "standard deviation of a light reading, in percent of full scale"},
      {0, 10}, robot.light_noise);
  v.number({"ir_range_cm", "range of the infrared sensors, from the rim"}, {0, 100},
           robot.ir_range);
  v.number({"status_rate_hz", "ROBOT_STATUS messages per second"}, {1, 200}, robot.status_rate);
  v.number({"lease_s",
            "a robot stops after this time without a further order; orders are sent every 0.2 s"},
           {0.4, 60}, robot.lease);
  v.number(
      {"free_run_s",
       "if longer than lease_s, a robot stops only after this time without a further order; 0: "
       "it stops after lease_s"},
      {0, kLongestFreeRun}, robot.free_run);
  v.flag({"resume_after_reboot",
          "a wire, firmware or serial robot that reboots during a run continues by itself; false: "
          "it stands "
          "until the run ends"},
         robot.resume_after_reboot);
  v.text({"motors",
          "motor calibrations of simulated robots: the calibration/motors.toml of a run of lab "
          "calibrate motors; path relative to the experiment file"},
         {.most = 400}, robot.motors);
}

void visitSerial(KeyVisitor& v, SerialLines& serial) {
  std::int64_t baud = serial.baud;
  v.text({"ports",
          "devices that may be robots, with * and ?, separated by spaces; opening a device resets "
          "its board"},
         {.most = 1000}, serial.ports);
  v.integer({"baud", "speed of the lines, as the firmware was built"}, 9600, 500000, baud);
  serial.baud = static_cast<int>(baud);
}

void visitRobot(KeyVisitor& v, RobotEntry& robot) {
  v.integer({"id", "the robot's number; with count, the first number", Need::kRequired}, 1,
            kLargestId, robot.id);
  v.integer({"count", "number of robots, which get consecutive ids"}, 1, kMostRobots, robot.count);
  const Selector body(
      v,
      {"body",
       "what the robot is (bodies.md); sim and wire: simulated; firmware: the real program on a "
       "simulated chip; serial: a real robot; replay: a recorded robot"},
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
                      {"uid", "serial number of the electronics, as robot_bridge --list shows it",
                       Need::kRequired}),
            1, 0xFFFFFFFFLL, robot.uid);
  v.text(body.only({Body::kReplay},
                   {"log", "log, or folder of a run; path relative to the experiment file",
                    Need::kRequired}),
         {.most = 400}, robot.log);
  v.integer(body.only({Body::kReplay}, {.name = "recorded_id",
                                        .meaning = "id of the robot in that log; 0: the same id"}),
            0, kLargestId, robot.recorded_id);
  v.number(body.only({Body::kReplay},
                     {"from_s", "time in that log's script at which the replay begins"}),
           {0, kLongestRun}, robot.from);
}

void visitSense(KeyVisitor& v, SenseSpec& sense) {
  v.integer({"sense", "i of sense(i)", Need::kRequired}, 0, dynamics::kSenses - 1, sense.index);
  const Selector is(v, {"is", "what the robot senses (programs.md)", Need::kRequired}, kSenseKinds,
                    sense.kind);
  v.number(is.only({SenseKind::kNeighbours, SenseKind::kDensity, SenseKind::kMeanHeading,
                    SenseKind::kNearestDistance, SenseKind::kNearestBearing},
                   {"radius_cm", "robots within this distance count, centre to centre"}),
           kLength, sense.radius);
  v.number(is.only({SenseKind::kPlaceDistance, SenseKind::kPlaceBearing},
                   {"x_cm", "the place, inside the arena", Need::kRequired}),
           kPlace, sense.x);
  v.number(is.only({SenseKind::kPlaceDistance, SenseKind::kPlaceBearing},
                   {"y_cm", "see x_cm", Need::kRequired}),
           kPlace, sense.y);
  v.text(is.only({SenseKind::kExpression},
                 {"value", "an expression of the other senses, as sense(0)*cos(sense(1))",
                  Need::kRequired}),
         {.most = 200}, sense.value);
}

void visitSenses(KeyVisitor& v, Senses& senses) {
  v.number({"rate_hz", "values per second"}, {0.1, 50}, senses.rate);
  v.number({"delay_ms",
            "from the exposure of the tracker's frame to the sending of the values; 0: as "
            "soon as the tracker has them, else a frame or more"},
           {0, 60000}, senses.delay);
  visitList(v, {"values", "what the host computes from the tracker's poses"},
            {.fewest = 0, .most = dynamics::kSenses, .in_line = true}, senses.values,
            [&](SenseSpec& sense) { visitSense(v, sense); });
}

void visitLightTable(KeyVisitor& v, LightTable& table) {
  enumerate(v, {"sensor", "which of the robot's two light sensors the bands are compared with"},
            kSensors, table.sensor);
  v.number(
      {"hysteresis",
       "a selected band is kept while the light is inside the band widened by this on both sides"},
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
  enumerate(v, {"on", "obstacles from which a robot turns back; any: walls and robots"}, kReverseOn,
            reversal.on);
  v.number({"distance_cm", "distance that it drives back (appendix B: about 40 cm)"}, {1, 400},
           reversal.distance);
  v.number({"speed_cm_s", "speed of driving back"}, {0.1, 500}, reversal.speed);
}

void visitCamera(KeyVisitor& v, Camera& camera) {
  const Selector tracker(v,
                         {"tracker",
                          "source of the robots' poses; sim: the simulator, with the errors below; "
                          "camera: tracker_svc, from pictures"},
                         kTrackers, camera.tracker);
  const auto painted = [&](Key key) { return tracker.only({Tracker::kCamera}, std::move(key)); };
  const auto modelled = [&](Key key) { return tracker.only({Tracker::kSimPoses}, std::move(key)); };
  v.text(painted({"camera",
                  "source of the pictures; sim: the camera that sim_svc simulates; pipeline: the "
                  "GStreamer pipeline of --camera-pipeline; else a device, a movie or an address "
                  "(docs/cameras.md)"}),
         {.most = 400}, camera.source);
  v.number({"fps", "frames per second"}, {1, 500}, camera.fps);
  std::int64_t width = camera.width;
  std::int64_t height = camera.height;
  v.integer(painted({"width_px", "width of the pictures"}), 160, 8192, width);
  v.integer(painted({"height_px", "height of the pictures"}), 120, 8192, height);
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  v.number(painted({"exposure_ms", "exposure time of a frame"}),
           {.low = 0, .high = 1000, .above_low = true}, camera.exposure);
  v.number(
      painted({"gain", "gain; for the simulated camera a factor, for a device in its own units"}),
      {0, 1e6}, camera.gain);
  v.text(painted({.name = "calibration",
                  .meaning =
                      "camera.json of lab calibrate camera; if empty, that of the simulated camera",
                  .default_text = "empty"}),
         {.most = 400}, camera.calibration);
  const Selector marker(v,
                        painted({"marker",
                                 "what marks robots in the pictures: caps with two circles, single "
                                 "blobs, or AprilTags with the robots' ids (docs/track.md)"}),
                        kMarkers, camera.marker);
  const auto blobs = [&](Key key) { return marker.only({Marker::kBlobs}, std::move(key)); };
  const auto tags = [&](Key key) { return marker.only({Marker::kTags}, std::move(key)); };
  enumerate(v, blobs({"blob", "whether blobs are darker or brighter than the ground"}), kBlobTones,
            camera.blob);
  v.number(blobs({"blob_smallest_cm", "smallest diameter of a disc with the area of one blob"}),
           {0.01, 100}, camera.blob_smallest);
  v.number(blobs({"blob_largest_cm", "largest diameter of a disc with the area of one blob"}),
           {0.01, 100}, camera.blob_largest);
  enumerate(v, tags({"tag_family", "family of the tags"}), kTagFamilies, camera.tag_family);
  v.number(tags({"tag_size_cm", "side of a tag, where its black border meets white"}), {0.1, 100},
           camera.tag_size);
  v.number(marker.only({Marker::kBlobs, Marker::kTags},
                       {"marker_height_cm", "height of blobs or tags above the floor"}),
           {0, 100}, camera.marker_height);
  v.flag(
      painted({"handshake",
               "before the script all robots turn by a code, so that the tracker can identify it"}),
      camera.handshake);
  std::int64_t port = camera.debug_port;
  v.integer(painted({"debug_port", "port of the tracker's debug view on 127.0.0.1, 0: none"}), 0,
            65535, port);
  camera.debug_port = static_cast<int>(port);
  v.number(painted({"ambient",
                    "room light in the simulated picture, as a fraction of the projector's white"}),
           kShare, camera.ambient);
  v.number(modelled({"position_noise_cm", "standard deviation of the errors of x and of y"}),
           {0, 5}, camera.position_noise);
  v.number(modelled({"heading_noise_deg", "standard deviation of the error of the heading"}),
           {0, 90}, camera.heading_noise);
  v.number({"delay_ms", "time from the exposure to the message, or to the simulated picture"},
           {0, 5000}, camera.delay);
  v.number(modelled({"dropout", "probability that one robot is missing in one frame"}),
           {.low = 0, .high = 1, .below_high = true}, camera.dropout);
  v.number({"frame_loss", "probability that a whole simulated frame is missing"},
           {.low = 0, .high = 1, .below_high = true}, camera.frame_loss);
  v.text(modelled({.name = "frames",
                   .meaning = "frames.csv of lab twin: the frames of a recorded run, in place of "
                              "fps, dropout and frame_loss",
                   .default_text = "empty"}),
         {.most = 400}, camera.frames);
  visitFilm(v, tracker, camera.film);
}

void visitRegion(KeyVisitor& v, RegionSpec& region) {
  v.text({"name", "name in report and messages", Need::kRequired}, {.most = 32, .bare = true},
         region.name);
  const Selector shape(v, {"shape", "what the region is", Need::kRequired}, kShapes, region.shape);
  v.number({"x_cm", "centre of the region", Need::kRequired}, kPlace, region.x);
  v.number({"y_cm", "centre of the region", Need::kRequired}, kPlace, region.y);
  v.number(shape.only({Region::kCircle}, {"radius_cm", "radius of the circle", Need::kRequired}),
           kLength, region.radius);
  v.number(shape.only({Region::kRectangle},
                      {"width_cm", "size of the rectangle along x", Need::kRequired}),
           kLength, region.width);
  v.number(shape.only({Region::kRectangle},
                      {"height_cm", "size of the rectangle along y", Need::kRequired}),
           kLength, region.height);
}

void visitAnalysis(KeyVisitor& v, AnalysisOptions& analysis) {
  v.number({"max_lag_s", "longest lag of the curves"}, {0.1, 3600}, analysis.max_lag);
  v.number({"results_every_s",
            "time between results while the experiment runs; 0: every second, in virtual time a "
            "tenth of the time so far "
            "from 1 to 10 s if neither script nor user program waits for them"},
           {0, 3600}, analysis.results_every);
  v.number({"cluster_distance_cm",
            "robots whose centres are closer belong to a cluster; 0: 1.1 diameters"},
           {0, 1000}, analysis.cluster_distance);
  visitList(v,
            {"regions",
             "parts of the arena of which times and fluxes are measured; a robot is in the first "
             "one that holds its centre"},
            {.fewest = 0, .most = 8, .in_line = true}, analysis.regions,
            [&](RegionSpec& region) { visitRegion(v, region); });
  std::int64_t twins = analysis.twins;
  v.integer({"twins",
             "at the end of a run, compare it with this many simulated twins (docs/twins.md); 0: "
             "none, else at least 10"},
            0, 1000, twins);
  analysis.twins = static_cast<int>(twins);
}

void visitCameraSpec(KeyVisitor& v, CameraSpec& camera) {
  v.text({"name", "name of this camera, in reports", Need::kRequired}, {.most = 32, .bare = true},
         camera.name);
  v.text({.name = "camera",
          .meaning = "source of its pictures; if empty, that of [camera]",
          .default_text = "empty"},
         {.most = 400}, camera.source);
  v.text({.name = "calibration",
          .meaning = "its camera.json; if empty, that of the simulated camera",
          .default_text = "empty"},
         {.most = 400}, camera.calibration);
  std::int64_t width = camera.width;
  std::int64_t height = camera.height;
  v.integer({"width_px", "width of its pictures; 0: that of [camera]"}, 0, 8192, width);
  v.integer({"height_px", "height of its pictures; 0: that of [camera]"}, 0, 8192, height);
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  v.number({"view_x_cm",
            "left border of its view: what the simulated camera sees, and whose corners lab "
            "calibrate camera needs"},
           {0, kLargestArena}, camera.view.x);
  v.number({"view_y_cm", "lower border of its view"}, {0, kLargestArena}, camera.view.y);
  v.number({"view_width_cm", "width of its view; 0: up to the border of the arena"},
           {0, kLargestArena}, camera.view.width);
  v.number({"view_height_cm", "height of its view; 0: up to the border of the arena"},
           {0, kLargestArena}, camera.view.height);
  v.number({"clock_error_ms", "the simulated camera's time stamps are too late by this"},
           {-1000, 1000}, camera.clock_error);
}

void visitTop(KeyVisitor& v, ExperimentForm& form) {
  Experiment& e = form.common;
  std::int64_t version = e.fileversion;
  std::int64_t seed = static_cast<std::int64_t>(e.seed);
  v.integer({"fileversion", "version of this format", Need::kRequired}, kFileVersion, kFileVersion,
            version);
  v.text({"name", "name of the run and of its folder", Need::kRequired},
         {.most = 64, .as_folder = true}, e.name);
  v.text({"description", "free text"}, {.most = 4000}, e.description);
  v.integer({"seed", "all random numbers are derived from it"}, 0,
            std::numeric_limits<std::int64_t>::max(), seed);
  v.number({"duration_s", "length of the run, at most ten days", Need::kRequired},
           {0.001, kLongestRun}, e.duration);
  v.text({"program",
          "shorthand for a light_table with one band over all light, and, if [light] has no steps, "
          "for a uniform light of 0.5",
          Need::kShorthand, "-"},
         {.most = 32, .bare = true}, form.program);
  visitStopOn(v, e.stop_on);
  e.fileversion = static_cast<int>(version);
  e.seed = static_cast<std::uint64_t>(seed);
}

}  // namespace

void visitKeys(KeyVisitor& v, ExperimentForm& form) {
  Experiment& e = form.common;
  visitTop(v, form);
  visitNetworks(v, e);
  v.table({"arena",
           "The arena: its corner is the origin, x runs along the width, y along the "
           "height"},
          [&] {
            v.number({"width_cm", "size along x"}, {10, kLargestArena}, e.arena_width);
            v.number({"height_cm", "size along y"}, {10, kLargestArena}, e.arena_height);
          });
  v.table(
      {"robot",
       "The robots' hardware, the same for all. The keys with error, noise and dead_band disturb "
       "simulated robots only; their programs do not know these values"},
      [&] { visitHardware(v, e.hardware); });
  v.table({"serial", "The lines to real robots (body = \"serial\")"},
          [&] { visitSerial(v, e.serial); });
  visitList(v, {"robots", "The robots that take part", Need::kRequired},
            {.fewest = 1, .most = kMostRobots}, form.robots,
            [&](RobotEntry& robot) { visitRobot(v, robot); });
  std::vector<std::string> names;
  for (const auto& [name, program] : e.programs) names.push_back(name);
  v.namedTables(
      {"programs", "What robots can do; choose NAME freely", Need::kRequired},
      {.most = kLongestProgramName, .bare = true}, {.fewest = 1, .most = 100}, names,
      [&](const std::string& name) { v.program(name, wheelLimits(e.hardware), e.programs[name]); });
  v.table({"senses",
           "Numbers that the host writes for programs, which read them as sense(0) to "
           "sense(7)"},
          [&] { visitSenses(v, e.senses); });
  v.table({"light_table", "Which light selects which program"},
          [&] { visitLightTable(v, e.light_table); });
  v.table({"reversal", "Turning back from obstacles (appendix B of the paper)"},
          [&] { visitReversal(v, e.reversal); });
  v.table({"light", "The light script"}, [&] { visitLight(v, form); });
  visitList(v,
            {"stop_when",
             "Rules that end the run before duration_s: a measured number is known well enough"},
            {.fewest = 0, .most = 20}, e.stop_when,
            [&](StopRule& rule) { visitStopRule(v, rule); });
  v.table({"projector", "The projector"}, [&] { visitProjector(v, e.projector); });
  v.table({"camera", "Camera and tracker"}, [&] { visitCamera(v, e.camera); });
  visitList(v,
            {"cameras",
             "Several cameras with overlapping views, in place of one (docs/track.md); what an "
             "entry does not set is that of [camera]"},
            {.fewest = 0, .most = kMostCameras}, e.cameras,
            [&](CameraSpec& camera) { visitCameraSpec(v, camera); });
  v.table({"analysis", "The analyzer"}, [&] { visitAnalysis(v, e.analysis); });
  v.table({"faults", "Simulated faults of a network"}, [&] {
    v.number(
        {"message_loss", "probability that a message does not reach a receiver, in virtual time"},
        {.low = 0, .high = 1, .below_high = true}, e.faults.message_loss);
  });
  v.table(
      {"sweep", "The campaign that lab sweep makes of this file (campaigns.md)", Need::kShorthand},
      [&] { visitSweep(v, form.sweep); });
}

}  // namespace lab::keys
