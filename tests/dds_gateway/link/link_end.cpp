/// A gateway with only its link, and a clock that can be shifted.
///   link_end LCM_URL HOST ADDRESS KEY CLOCK_SHIFT_US MOST_OFFSET_S PEER...
/// $LINK_END_SPEAKS gives it another contract with these type fingerprints. $LINK_END_SECURITY is
/// the folder of its certificates.
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <span>
#include <thread>

#include "common/bus/lcm_bus.hpp"
#include "common/loop/asio_loop.hpp"
#include "dds_gateway/link/bus_link.hpp"

namespace {

void run(std::span<char*> arguments) {
  lab::gateway::BusLinkOptions options;
  options.host = arguments[2];
  options.address = arguments[3];
  options.key = arguments[4];
  const std::int64_t shift = std::atoll(arguments[5]);
  options.max_offset = std::atof(arguments[6]);
  options.peers.assign(arguments.begin() + 7, arguments.end());
  if (const char* types = std::getenv("LINK_END_SPEAKS")) options.protocol = {3, types, "0.0.9"};
  if (const char* folder = std::getenv("LINK_END_SECURITY")) options.security = folder;
  lab::AsioLoop loop;
  options.clock = [&loop, shift] { return loop.now() + shift; };
  lab::LcmBus bus(arguments[1]);
  lab::Node node(bus, loop, {"dds_gateway", 0, loop.now()});
  lab::gateway::BusLink link(node, loop, loop, options);
  loop.onReadable(bus.fileDescriptor(), [&bus] { bus.drain(); });
  loop.onSignals({SIGINT, SIGTERM}, [&loop](int) { loop.stop(); });
  node.start();
  node.ready();
  loop.run();
  node.close();
  for (int i = 0; link.isForwarding() && i < 250; ++i) {
    loop.poll();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run({argv, static_cast<std::size_t>(argc)});
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "link_end: %s\n", error.what());
    return 1;
  }
}
