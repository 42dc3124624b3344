#include "common/experiment/checks/robot_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/experiment/checks/program_checks.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/files/file_values.hpp"
#include "robot/wire/fields.hpp"
#include "robot/wire/frame.hpp"
#include "robot/wire/messages.hpp"

namespace lab::keys {
namespace {

constexpr double kWallSlack = 1e-9;  // [m] so that a robot may touch the wall

/// Largest covered fraction of the arena. The densest packing of discs covers 0.907; this leaves
/// room for random placement and for motion.
constexpr double kLargestCover = 0.6;

constexpr double kFastestScan = 0.01;  // [s] duration of a scan of the robot's eight channels

/// Baud rates that the robot's 8 MHz clock meets within 0.2 % and that every serial line supports.
constexpr std::array kBauds = {9600, 38400, 500000};
constexpr int kChipBaud = 38400;  // of the line between sim_svc and the simulated chips

std::string entryPath(std::size_t index) { return "robots[" + std::to_string(index) + "]"; }

/// Whether the sizes of arena and robots have no problem; checks of places need them.
bool sizesAreKnown(const Problems& problems) {
  return !problems.concern("arena.width_cm") && !problems.concern("arena.height_cm") &&
         !problems.concern("robot.diameter_cm");
}

/// Largest side of an arena [m] that a camera films, or ROS 2 gets a map of.
constexpr double kLargestFilmedArena = 10;

void checkArena(const ExperimentForm& form, Problems& problems) {
  const Experiment& e = form.common;
  const bool filmed = e.camera.tracker == Tracker::kCamera;
  if (!filmed && !e.gateway.ros) return;
  const auto check = [&](const char* key, double size) {
    if (size <= kLargestFilmedArena || problems.concern(key)) return;
    problems.add(key, "found " + centimetreText(size) + ", allowed 10 to " +
                          centimetreText(kLargestFilmedArena) + " with " +
                          (filmed ? "camera.tracker = \"camera\"" : "gateway.ros = true"));
  };
  check("arena.width_cm", e.arena_width);
  check("arena.height_cm", e.arena_height);
}

void checkIds(const ExperimentForm& form, Problems& problems) {
  std::map<std::int64_t, std::size_t> owners;
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
    for (std::int64_t id = entry.id; id <= last; ++id) {
      const auto [owner, is_new] = owners.emplace(id, i);
      if (is_new) continue;
      problems.add(entryPath(i) + ".id", "found id " + std::to_string(id) + ", which " +
                                             entryPath(owner->second) +
                                             " already has, allowed an id of its own");
      break;
    }
  }
}

/// Checks of robots on serial lines.
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

/// Checks that the senses leave a part of each robot's line to the host's other messages, of which
/// a STOP waits for those before it. Lines of simulated robots are as slow as real ones.
void checkSenseRate(const ExperimentForm& form, Problems& problems) {
  constexpr int kFrameBits =
      10 * (wire::payloadSize<wire::SetSenses>() + wire::kFrameOverhead);  // with start and stop
  const bool on_lines = std::ranges::any_of(
      form.robots, [](const RobotEntry& entry) { return isOnWire(entry.body); });
  if (form.recorded || !on_lines || form.common.senses.values.empty() ||
      problems.concern("serial.baud") || problems.concern("senses.rate_hz")) {
    return;
  }
  const int baud = form.common.serial.baud;
  constexpr double kShare = wire::SetSenses::kMostPercent / 100.0;
  const double most = kShare * baud / kFrameBits;
  const double rate = form.common.senses.rate;
  if (rate <= most) return;
  problems.add("senses.rate_hz",
               "found " + numberText(rate) + ", allowed up to " +
                   numberText(std::floor(10 * most) / 10) +
                   " for robots on lines of serial.baud = " + std::to_string(baud) +
                   ": the values may take " + std::to_string(wire::SetSenses::kMostPercent) +
                   " % of a line");
}

void checkInside(const std::string& path, double place, double size, double radius,
                 Problems& problems) {
  if (place >= radius - kWallSlack && place <= size - radius + kWallSlack) return;
  problems.add(path, "found " + centimetreText(place) + ", allowed " + centimetreText(radius) +
                         " to " + centimetreText(size - radius) + " (inside the arena)");
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
  // Earlier places by cells as wide as a robot: only neighbours can overlap.
  using Cell = std::pair<std::int64_t, std::int64_t>;
  std::map<Cell, std::vector<std::size_t>> placed;
  const auto cellOf = [diameter](double place) {
    return static_cast<std::int64_t>(std::floor(place / diameter));
  };
  for (std::size_t i = 0; i < form.robots.size(); ++i) {
    const RobotEntry& a = form.robots[i];
    // A robot with another problem may still have a valid place.
    if (!a.x || !a.y || problems.concern(entryPath(i) + ".x_cm") ||
        problems.concern(entryPath(i) + ".y_cm")) {
      continue;
    }
    const Cell cell = {cellOf(*a.x), cellOf(*a.y)};
    std::optional<std::size_t> other;
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto near = placed.find({cell.first + dx, cell.second + dy});
        if (near == placed.end()) continue;
        for (const std::size_t j : near->second) {
          const RobotEntry& b = form.robots[j];
          if (std::hypot(*a.x - *b.x, *a.y - *b.y) < diameter)
            other = std::min(other.value_or(j), j);
        }
      }
    }
    placed[cell].push_back(i);
    if (!other) continue;
    const RobotEntry& b = form.robots[*other];
    problems.add(entryPath(i) + ".x_cm",
                 "found a place " + centimetreText(std::hypot(*a.x - *b.x, *a.y - *b.y)) +
                     " cm from that of " + entryPath(*other) +
                     ", allowed at least robot.diameter_cm = " + centimetreText(diameter));
  }
}

void checkRoom(const ExperimentForm& form, Problems& problems) {
  std::int64_t robots = 0;
  for (const RobotEntry& entry : form.robots) robots += entry.count;
  const double radius = form.common.hardware.diameter / 2;
  const double area = form.common.arena_width * form.common.arena_height;
  const double one = std::numbers::pi * radius * radius / area;
  if (2 * radius > std::min(form.common.arena_width, form.common.arena_height)) {
    problems.add("robot.diameter_cm", "found " + centimetreText(2 * radius) +
                                          ", allowed at most the arena's width and height");
  } else if (static_cast<double>(robots) * one > kLargestCover) {
    problems.add("robots", "found " + std::to_string(robots) + " robots, allowed at most " +
                               std::to_string(static_cast<std::int64_t>(kLargestCover / one)) +
                               " of this diameter on this arena (they may cover " +
                               numberText(kLargestCover * 100) + " % of it)");
  }
}

void checkReversal(const ExperimentForm& form, Problems& problems) {
  const Reversal& reversal = form.common.reversal;
  const RobotHardware& robot = form.common.hardware;
  if (reversal.on == ReverseOn::kNever || problems.concern("reversal")) return;
  if (wheelsAreKnown(problems) && reversal.speed > robot.max_wheel_speed) {
    problems.add("reversal.speed_cm_s",
                 "found " + centimetreText(reversal.speed) + ", allowed 0.1 to " +
                     centimetreText(robot.max_wheel_speed) + " (robot.max_wheel_speed_cm_s)");
  }
  if (!sizesAreKnown(problems)) return;
  const double room = std::min(form.common.arena_width, form.common.arena_height) - robot.diameter;
  if (reversal.distance > room) {
    problems.add("reversal.distance_cm", "found " + centimetreText(reversal.distance) +
                                             ", allowed 1 to " + centimetreText(room) +
                                             " (within the arena)");
  }
}

}  // namespace

void checkRobots(const ExperimentForm& form, Problems& problems) {
  checkArena(form, problems);
  checkIds(form, problems);
  checkLines(form, problems);
  checkSenseRate(form, problems);
  for (std::size_t i = 0; i < form.robots.size(); ++i) {
    if (!problems.concern(entryPath(i))) checkPose(form, i, problems);
  }
  if (sizesAreKnown(problems)) {
    const bool counts_are_known = !problems.concern("robots");
    checkOverlaps(form, problems);
    if (counts_are_known) checkRoom(form, problems);
  }
  checkPrograms(form, problems);
  checkReversal(form, problems);
}

}  // namespace lab::keys
