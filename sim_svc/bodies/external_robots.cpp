#include "sim_svc/bodies/external_robots.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace lab::sim {

std::string lineName(std::int32_t robot_id) {
  const std::string number = std::to_string(robot_id);
  return "robot_" + (number.size() < 2 ? "0" + number : number);
}

void ExternalRobots::add(std::unique_ptr<BodyDriver> driver) {
  for (std::size_t k = 0; k < driver->size(); ++k) {
    Robot& robot = robots_[driver->body(k)];
    robot.driver = driver.get();
    robot.k = k;
    robot.port = ports_.offer(lineName(world_.id(driver->body(k))));
    robot.port->onReadable([this, &robot] { readBytes(robot); });
  }
  drivers_.push_back(std::move(driver));
}

void ExternalRobots::readBytes(Robot& robot) {
  catch_up_();
  std::array<std::uint8_t, 512> bytes{};
  while (const std::size_t count = robot.port->read(bytes)) {
    robot.driver->receive(robot.k, std::span(bytes).first(count));
  }
}

void ExternalRobots::advanceTo(std::int64_t time_us) {
  if (drivers_.empty()) {
    world_.advanceTo(time_us);
    return;
  }
  while (world_.timeUs() < time_us) {
    const std::int64_t next = (world_.timeUs() / kSlice_us + 1) * kSlice_us;
    const std::int64_t until = std::min(next, time_us);
    for (const auto& driver : drivers_) {
      driver->advance(world_, until);
    }
    world_.advanceTo(until);
    for (const auto& [body, robot] : robots_) {
      const std::span<const std::uint8_t> sent = robot.driver->sent(robot.k);
      // Bytes that the line does not accept are lost, as on a cable without a reader. They are not
      // counted here: a reader counts the damaged frames and the gaps in their numbers.
      if (!sent.empty()) static_cast<void>(robot.port->write(sent));
    }
  }
}

std::int64_t ExternalRobots::program(std::size_t i) const {
  const auto robot = robots_.find(i);
  return robot == robots_.end() ? BodyDriver::kUnknown
                                : robot->second.driver->program(robot->second.k);
}

}  // namespace lab::sim
