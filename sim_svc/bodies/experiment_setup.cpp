#include "sim_svc/bodies/experiment_setup.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace lab::sim {

WorldSettings worldSettings(const Experiment& experiment) {
  const RobotHardware& hardware = experiment.hardware;
  WorldSettings settings;
  settings.arena = {experiment.arena_width, experiment.arena_height};
  settings.seed = experiment.seed;
  settings.radius = hardware.diameter / 2;
  settings.wheel_base = hardware.diameter;
  settings.max_wheel_speed = hardware.max_wheel_speed;
  settings.pwm_steps = hardware.pwm_steps;
  settings.wheel_gain_error = hardware.wheel_gain_error;
  settings.light_gain_error = hardware.light_gain_error;
  settings.light_noise = 1023 * hardware.light_noise;
  settings.wheel_base_error = hardware.wheel_base_error;
  settings.motor_dead_band = hardware.motor_dead_band;
  settings.speed_noise = hardware.speed_noise;
  settings.turn_noise = hardware.turn_noise;
  settings.clock_error = hardware.clock_error;
  settings.ir_range = hardware.ir_range;
  settings.contact = hardware.contact == Contact::kSlide ? ContactRule::kSlide : ContactRule::kStop;
  settings.contact_friction = hardware.contact_friction;
  settings.slip = {hardware.slip_across, hardware.slip_turn};
  return settings;
}

std::vector<RobotSetup> simulatedRobots(const Experiment& experiment) {
  std::vector<RobotSetup> robots;
  for (const RobotSpec& robot : experiment.robots) {
    if (!isSimulated(robot.body)) continue;
    RobotSetup setup;
    setup.id = robot.id;
    setup.external = robot.body != Body::kSim;
    if (robot.start)
      setup.pose = dynamics::Pose{robot.start->x, robot.start->y, robot.start->theta};
    robots.push_back(setup);
  }
  return robots;
}

std::vector<std::size_t> robotsWithBody(const Experiment& experiment, Body body) {
  std::vector<std::size_t> bodies;
  std::size_t i = 0;
  for (const RobotSpec& robot : experiment.robots) {
    if (robot.body == body) bodies.push_back(i);
    if (isSimulated(robot.body)) ++i;
  }
  return bodies;
}

MotorCalibrations activeMotors(const Experiment& experiment,
                               const std::filesystem::path& directory) {
  const std::string& file = experiment.hardware.motors;
  return file.empty() ? MotorCalibrations{} : readMotorFile(directory / file);
}

robot_calibration_t toMessage(const MotorCalibrations& motors) {
  robot_calibration_t message{};
  for (const auto& [id, robot] : motors) message.robots.push_back(robot);
  message.num_robots = static_cast<std::int32_t>(message.robots.size());
  return message;
}

firmware::Settings storedSettings(const Experiment& experiment, const MotorCalibrations& motors,
                                  std::int32_t id) {
  firmware::Settings settings;
  settings.uid = simulatedUid(id);
  settings.wheel_base_um =
      static_cast<std::int32_t>(std::lround(experiment.hardware.diameter * 1e6));
  const auto calibrated = motors.find(id);
  if (calibrated == motors.end()) return settings;
  const motor_calibration_t& robot = calibrated->second;
  settings.left = wheelCalibration(robot.gain_left, robot.dead_band_left);
  settings.right = wheelCalibration(robot.gain_right, robot.dead_band_right);
  settings.wheel_base_um = static_cast<std::int32_t>(std::lround(robot.wheel_base * 1e6));
  return settings;
}

dynamics::WheelCalibration wheelCalibration(double gain, double dead_band) {
  dynamics::WheelCalibration wheel;
  wheel.gain_ppm = static_cast<std::int32_t>(std::lround(std::clamp(gain, 0.5, 1.5) * 1e6));
  const double duty = std::clamp(dead_band, 0.0, 0.5) * dynamics::kMaxDuty;
  wheel.dead_band = static_cast<std::uint8_t>(std::min(127L, std::lround(duty)));
  return wheel;
}

}  // namespace lab::sim
