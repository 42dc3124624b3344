// Robots on pseudo terminals that run the firmware in real time, and a lab that commands them, for
// robot_bridge_benchmark.sh.
//   robot_bridge_farm ROBOTS FOLDER EXPERIMENT LCM_URL SECONDS
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <lab/robot_status_t.hpp>
#include <map>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/serial/serial_devices.hpp"
#include "common/service/node.hpp"
#include "tests/support/wire_robot.hpp"

namespace {

constexpr std::int64_t kCommandPeriod_us = 200'000;

int run(int count, const char* folder, const char* file, const char* url, double seconds) {
  const lab::Experiment experiment = lab::loadExperiment(file);
  lab::AsioLoop loop;
  lab::SerialDevices ports(loop, folder);
  std::deque<lab::bridge::WireRobot> robots;
  for (int id = 1; id <= count; ++id) {
    lab::bridge::WireRobotOptions options;
    options.uid = lab::simulatedUid(id);
    lab::bridge::WireRobot& robot = robots.emplace_back(loop, ports, options);
    robot.sensors().light_front = robot.sensors().light_back = 400;
    robot.plug("robot_" + std::to_string(id));
  }
  lab::LcmBus bus(url);
  lab::Node node(bus, loop, {"lab", 0, loop.now()});
  lab::robot_command_t command = lab::lightTableCommand(experiment);
  command.seq = 1;
  loop.every(kCommandPeriod_us, loop.now(), [&] {
    command.utime = loop.now();
    node.publishCommand(lab::channels::kRobotCommand, command);
  });
  std::map<std::int32_t, std::int64_t> last_utime;
  long samples = 0;
  node.subscribe<lab::robot_status_t>(lab::channels::kRobotStatus,
                                      [&](const lab::robot_status_t& status) {
                                        for (const lab::robot_state_t& robot : status.robots) {
                                          if (robot.command_seq != command.seq) continue;
                                          std::int64_t& utime = last_utime[robot.robot_id];
                                          if (robot.utime != utime) ++samples;
                                          utime = robot.utime;
                                        }
                                      });
  loop.onReadable(bus.fileDescriptor(), [&bus] { bus.drain(); });
  loop.at(loop.now() + static_cast<std::int64_t>(seconds * 1e6), [&loop] { loop.stop(); });
  loop.run();
  std::printf("%zu robots obeyed, %ld samples\n", last_utime.size(), samples);
  return last_utime.size() == static_cast<std::size_t>(count) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: robot_bridge_farm ROBOTS FOLDER EXPERIMENT LCM_URL SECONDS\n");
    return 2;
  }
  return run(std::atoi(argv[1]), argv[2], argv[3], argv[4], std::atof(argv[5]));
}
