#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "common/experiment/checks/experiment_checks.hpp"
#include "common/experiment/experiment_conversions.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/files/file_values.hpp"

namespace lab::keys {
namespace {

constexpr double kRoundingSlack = 1e-9;  // [m] so that a robot may touch the wall

/// The densest packing covers 0.907; this leaves room to find random places and to move.
constexpr double kLargestCover = 0.6;

constexpr double kFastestScan = 0.01;  // [s] of the robot's eight channels

/// Speeds that an 8 MHz robot meets within 0.2 % and that every serial line knows.
constexpr std::array kBauds = {9600, 38400, 500000};
constexpr int kChipBaud = 38400;  // of the line between sim_svc and its chips

std::string entryPath(std::size_t index) { return "robots[" + std::to_string(index) + "]"; }

/// Without the last digits, in which sums and differences differ from what a person expects.
std::string cm(double metre) {
  constexpr double kDigits = 1e9;
  return numberText(std::round(metre * 100 * kDigits) / kDigits);
}

/// Whether the sizes of arena and robots are known, as nothing about places can be said without.
bool sizesAreKnown(const Problems& problems) {
  return !problems.concern("arena.width_cm") && !problems.concern("arena.height_cm") &&
         !problems.concern("robot.diameter_cm");
}

bool wheelsAreKnown(const Problems& problems) {
  return !problems.concern("robot.diameter_cm") &&
         !problems.concern("robot.max_wheel_speed_cm_s") &&
         !problems.concern("robot.sensor_period_ms");
}

void checkIds(const ExperimentForm& form, Problems& problems) {
  std::map<std::int64_t, std::size_t> owners;
  std::int64_t robots = 0;
  for (std::size_t i = 0; i < form.robots.size(); ++i) {
    if (problems.concern(entryPath(i))) continue;
    const RobotEntry& entry = form.robots[i];
    const std::int64_t last = entry.id + entry.count - 1;
    if (last > kLargestId) {
      problems.add(entryPath(i) + ".count", "found " + std::to_string(entry.count) +
                                                ", which leads up to id " + std::to_string(last) +
                                                ", allowed ids 1 to " + std::to_string(kLargestId));
      continue;
    }
    robots += entry.count;
    for (std::int64_t id = entry.id; id <= last; ++id) {
      const auto [owner, is_new] = owners.emplace(id, i);
      if (is_new) continue;
      problems.add(entryPath(i) + ".id", "found id " + std::to_string(id) + ", which " +
                                             entryPath(owner->second) +
                                             " already has, allowed an id of its own");
      break;
    }
  }
  if (robots > kMostRobots) {
    problems.add("robots", "found " + std::to_string(robots) + " robots, allowed 1 to " +
                               std::to_string(kMostRobots));
  }
}

/// What only robots on the wire ask of the file.
void checkLines(const ExperimentForm& form, Problems& problems) {
  const RobotHardware& hardware = form.common.hardware;
  std::map<std::int64_t, std::size_t> uids;
  bool any = false;
  bool chips = false;
  for (std::size_t i = 0; i < form.robots.size(); ++i) {
    const RobotEntry& entry = form.robots[i];
    if (problems.concern(entryPath(i))) continue;
    any = any || entry.body == Body::kWire || entry.body == Body::kFirmware;
    chips = chips || entry.body == Body::kFirmware;
    if (entry.body != Body::kSerial) continue;
    if (entry.count > 1) {
      problems.add(entryPath(i) + ".count",
                   "found " + std::to_string(entry.count) + ", allowed 1 where a uid is given");
    }
    const auto [owner, is_new] = uids.emplace(entry.uid, i);
    if (!is_new) {
      problems.add(entryPath(i) + ".uid", "found the uid that " + entryPath(owner->second) +
                                              " already has, allowed one of its own");
    }
  }
  if (any && !hardware.pwm_steps && !problems.concern("robot.pwm_steps")) {
    problems.add("robot.pwm_steps",
                 "found false, allowed true with body = \"wire\" or \"firmware\": their wheels are "
                 "driven by PWM");
  }
  if (any && hardware.sensor_period < kFastestScan && !problems.concern("robot.sensor_period_ms")) {
    problems.add("robot.sensor_period_ms",
                 "found " + numberText(hardware.sensor_period * 1000) +
                     ", allowed 10 to 1000 with robots on the wire: a scan takes 10 ms");
  }
  const int baud = form.common.serial.baud;
  if (!problems.concern("serial.baud") && std::ranges::find(kBauds, baud) == kBauds.end()) {
    problems.add("serial.baud",
                 "found " + std::to_string(baud) + ", allowed 9600, 38400 or 500000");
  } else if (!problems.concern("serial.baud") && chips && baud != kChipBaud) {
    problems.add("serial.baud", "found " + std::to_string(baud) +
                                    ", allowed 38400 with body = \"firmware\": the simulated chips "
                                    "run the firmware as it is shipped");
  }
}

void checkInside(const std::string& path, double place, double size, double radius,
                 Problems& problems) {
  if (place >= radius - kRoundingSlack && place <= size - radius + kRoundingSlack) return;
  problems.add(path, "found " + cm(place) + ", allowed " + cm(radius) + " to " + cm(size - radius) +
                         " (inside the arena)");
}

void checkPose(const ExperimentForm& form, std::size_t index, Problems& problems) {
  const RobotEntry& entry = form.robots[index];
  const std::string path = entryPath(index);
  const int given = (entry.x ? 1 : 0) + (entry.y ? 1 : 0) + (entry.theta ? 1 : 0);
  if (given == 0) return;
  if (!isSimulated(entry.body)) {
    problems.add(path + ".x_cm",
                 "found a start for a robot that no simulator places, allowed with "
                 "body = \"sim\", \"wire\" or \"firmware\"");
    return;
  }
  if (given < 3) {
    const char* key = entry.x ? ".x_cm" : entry.y ? ".y_cm" : ".theta_deg";
    problems.add(path + key,
                 "found " + std::to_string(given) +
                     " of x_cm, y_cm and theta_deg, allowed all three, or none for a random "
                     "start");
    return;
  }
  if (entry.count > 1) {
    problems.add(path + ".count", "found " + std::to_string(entry.count) +
                                      ", allowed 1 where x_cm, y_cm and theta_deg are given");
  }
  if (!sizesAreKnown(problems)) return;
  const double radius = form.common.hardware.diameter / 2;
  checkInside(path + ".x_cm", *entry.x, form.common.arena_width, radius, problems);
  checkInside(path + ".y_cm", *entry.y, form.common.arena_height, radius, problems);
}

void checkOverlaps(const ExperimentForm& form, Problems& problems) {
  const double diameter = form.common.hardware.diameter;
  // Of these alone: whatever else is wrong with a robot, its place may be a good one.
  std::vector<bool> has_place;
  for (std::size_t i = 0; i < form.robots.size(); ++i) {
    has_place.push_back(form.robots[i].x && form.robots[i].y &&
                        !problems.concern(entryPath(i) + ".x_cm") &&
                        !problems.concern(entryPath(i) + ".y_cm"));
  }
  for (std::size_t i = 0; i < form.robots.size(); ++i) {
    const RobotEntry& a = form.robots[i];
    for (std::size_t j = 0; j < i && has_place[i]; ++j) {
      const RobotEntry& b = form.robots[j];
      if (!has_place[j]) continue;
      const double distance = std::hypot(*a.x - *b.x, *a.y - *b.y);
      if (distance >= diameter) continue;
      problems.add(entryPath(i) + ".x_cm",
                   "found a place " + cm(distance) + " cm from that of " + entryPath(j) +
                       ", allowed at least robot.diameter_cm = " + cm(diameter));
      break;
    }
  }
}

void checkRoom(const ExperimentForm& form, Problems& problems) {
  std::int64_t robots = 0;
  for (const RobotEntry& entry : form.robots) robots += entry.count;
  const double radius = form.common.hardware.diameter / 2;
  const double area = form.common.arena_width * form.common.arena_height;
  const double one = std::numbers::pi * radius * radius / area;
  if (2 * radius > std::min(form.common.arena_width, form.common.arena_height)) {
    problems.add("robot.diameter_cm",
                 "found " + cm(2 * radius) + ", allowed at most the arena's width and height");
  } else if (static_cast<double>(robots) * one > kLargestCover) {
    problems.add("robots", "found " + std::to_string(robots) + " robots, allowed at most " +
                               std::to_string(static_cast<std::int64_t>(kLargestCover / one)) +
                               " of this diameter on this arena (they may cover " +
                               numberText(kLargestCover * 100) + " % of it)");
  }
}

std::string wayOut(Model model) {
  switch (model) {
    case Model::kAbp:
      return "lower v_cm_s or eta_rad_s";
    case Model::kNoisyAbp:
      return "lower V_cm_s or va_cm_s";
    case Model::kBp:
      return "lower V_cm_s";
    case Model::kRtp:
      return "lower v_cm_s or raise tau_t_s";
    default:
      return "lower the wheel speeds";
  }
}

void checkTime(const std::string& path, double time, double sensor_period, Problems& problems) {
  const double milliseconds = time * 1000;
  if (std::abs(milliseconds - std::round(milliseconds)) > 1e-6) {
    problems.add(path, "found " + numberText(time) + ", allowed whole milliseconds, as " +
                           numberText(std::max(1.0, std::round(milliseconds)) / 1000));
  } else if (time < sensor_period * (1 - kRoundingSlack)) {
    problems.add(path, "found " + numberText(time) + ", allowed at least " +
                           numberText(sensor_period) + " (robot.sensor_period_ms)");
  }
}

void checkProgram(const ProgramSpec& program, const RobotHardware& hardware, Problems& problems) {
  const std::string path = "programs." + program.name;
  if (problems.concern(path) || !wheelsAreKnown(problems)) return;
  const Model model = program.model;
  if (model == Model::kAbp || model == Model::kNoisyAbp || model == Model::kBp) {
    checkTime(path + ".epsilon_s", program.epsilon, hardware.sensor_period, problems);
  }
  if (model == Model::kRtp) {
    checkTime(path + ".tau_t_s", program.tau_t, hardware.sensor_period, problems);
  }
  if (problems.concern(path)) return;
  const auto result = dynamics::toProgramParams(toPhysics(program), wheelLimits(hardware));
  if (!result.ok) {
    problems.add(path, "found " + result.reason + "; allowed: " + wayOut(model) +
                           ", or raise robot.max_wheel_speed_cm_s");
  }
}

void checkTwins(const std::map<std::string, ProgramSpec>& programs, Problems& problems) {
  for (auto twin = programs.begin(); twin != programs.end(); ++twin) {
    for (auto first = programs.begin(); first != twin; ++first) {
      if (!sameProgram(toMessage(first->second), toMessage(twin->second))) continue;
      problems.add("programs." + twin->first,
                   "found the same as programs." + first->first +
                       ", allowed programs that differ: the analyzer knows them by what they do");
      break;
    }
  }
}

void checkReversal(const ExperimentForm& form, Problems& problems) {
  const Reversal& reversal = form.common.reversal;
  const RobotHardware& robot = form.common.hardware;
  if (reversal.on == ReverseOn::kNever || problems.concern("reversal")) return;
  if (wheelsAreKnown(problems) && reversal.speed > robot.max_wheel_speed) {
    problems.add("reversal.speed_cm_s", "found " + cm(reversal.speed) + ", allowed 0.1 to " +
                                            cm(robot.max_wheel_speed) +
                                            " (robot.max_wheel_speed_cm_s)");
  }
  if (!sizesAreKnown(problems)) return;
  const double room = std::min(form.common.arena_width, form.common.arena_height) - robot.diameter;
  if (reversal.distance > room) {
    problems.add("reversal.distance_cm", "found " + cm(reversal.distance) + ", allowed 1 to " +
                                             cm(room) + " (within the arena)");
  }
}

}  // namespace

void checkCamera(const ExperimentForm& form, Problems& problems) {
  const Camera& camera = form.common.camera;
  if (camera.tracker != Tracker::kCamera || problems.concern("camera")) return;
  if (camera.source.empty()) {
    problems.add("camera.camera", "found an empty text, allowed \"sim\", a device, a film, ...");
  } else if (!isPainted(camera) && camera.calibration.empty()) {
    problems.add("camera.calibration",
                 "found none, needed for any camera but \"sim\" (lab calibrate camera)");
  } else if (!isPainted(camera) && !problems.concern("robots") &&
             std::ranges::none_of(form.robots, [](const RobotEntry& entry) {
               return entry.body == Body::kSerial;
             })) {
    problems.add("camera.camera", "found \"" + camera.source +
                                      "\", but no robot with body = \"serial\" that it could see; "
                                      "simulated robots are seen by camera = \"sim\"");
  }
}

void checkRobots(const ExperimentForm& form, Problems& problems) {
  checkIds(form, problems);
  checkLines(form, problems);
  for (std::size_t i = 0; i < form.robots.size(); ++i) {
    if (!problems.concern(entryPath(i))) checkPose(form, i, problems);
  }
  if (sizesAreKnown(problems)) {
    const bool counts_are_known = !problems.concern("robots");
    checkOverlaps(form, problems);
    if (counts_are_known) checkRoom(form, problems);
  }
  for (const auto& [name, program] : form.common.programs) {
    checkProgram(program, form.common.hardware, problems);
  }
  if (!problems.concern("programs")) checkTwins(form.common.programs, problems);
  checkReversal(form, problems);
}

}  // namespace lab::keys
