// What receiving costs: CPU time per message of LcmBus and of liblcm alone, in the same run, for
// messages of several sizes. A child process sends them at a steady rate.
//   bus_receive_benchmark RESULT.csv     (in a private network)
#include <lcm/lcm.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/lcm_bus.hpp"

namespace {

constexpr int kPort = 7811;
constexpr int kMessages = 4'000;
constexpr int kRepeats = 3;  // of which the fastest counts
constexpr int kTick_ms = 2;
constexpr int kPerTick = 8;  // 4000 messages/s
constexpr int kTimeout_ms = 2'000;
constexpr double kMostRatio = 2;  // of the two CPU times

double cpuSeconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

using Lcm = std::unique_ptr<lcm_t, decltype(&lcm_destroy)>;

/// Sends until it is killed.
pid_t startSender(std::size_t size) {
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child != 0) return child;
  const Lcm lcm(lcm_create(lab::lcmUrl(kPort).c_str()), &lcm_destroy);
  const std::vector<std::uint8_t> data(size, 'x');
  auto next = std::chrono::steady_clock::now();
  while (getppid() == parent) {
    for (int i = 0; i < kPerTick; ++i) {
      lcm_publish(lcm.get(), "BENCHMARK", data.data(), static_cast<unsigned int>(size));
    }
    next += std::chrono::milliseconds(kTick_ms);
    std::this_thread::sleep_until(next);
  }
  _exit(0);
}

/// @param handle handles what has come; returns how many messages
/// @return CPU time per message [us], of this process
double measure(int descriptor, const std::function<int()>& handle) {
  const auto receive = [&](int messages) {
    for (int heard = 0; heard < messages;) {
      pollfd readable{descriptor, POLLIN, 0};
      if (poll(&readable, 1, kTimeout_ms) != 1) throw std::runtime_error("no messages");
      heard += handle();
    }
  };
  receive(kMessages / 10);
  const double before = cpuSeconds();
  receive(kMessages);
  return (cpuSeconds() - before) / kMessages * 1e6;
}

double measureBus() {
  lab::LcmBus bus(lab::lcmUrl(kPort));
  int heard = 0;
  bus.subscribe("BENCHMARK", [&heard](const lab::Packet&) { ++heard; });
  return measure(bus.fileDescriptor(), [&] {
    const int before = heard;
    bus.drain();
    return heard - before;
  });
}

double measureLiblcm() {
  const Lcm lcm(lcm_create(lab::lcmUrl(kPort).c_str()), &lcm_destroy);
  int heard = 0;
  lcm_subscription_t* subscription = lcm_subscribe(
      lcm.get(), "BENCHMARK",
      [](const lcm_recv_buf_t*, const char*, void* count) { ++*static_cast<int*>(count); }, &heard);
  lcm_subscription_set_queue_capacity(subscription, 0);
  return measure(lcm_get_fileno(lcm.get()), [&] {
    const int before = heard;
    while (lcm_handle_timeout(lcm.get(), 0) > 0) {
    }
    return heard - before;
  });
}

}  // namespace

int main(int argc, char** argv) {
  std::ofstream csv(argc > 1 ? argv[1] : "/dev/null");
  bool is_fast = true;
  csv << "bytes,lcm_bus_us,liblcm_us,ratio\n";
  std::puts("  bytes  LcmBus us  liblcm us  ratio");
  for (const std::size_t size : {100U, 2'000U, 20'000U, 60'000U, 200'000U}) {
    const pid_t sender = startSender(size);
    double ours = 1e9;
    double theirs = 1e9;
    for (int i = 0; i < kRepeats; ++i) {
      ours = std::min(ours, measureBus());
      theirs = std::min(theirs, measureLiblcm());
    }
    kill(sender, SIGKILL);
    waitpid(sender, nullptr, 0);
    std::printf("%7zu %10.2f %10.2f %6.2f\n", size, ours, theirs, ours / theirs);
    csv << size << ',' << ours << ',' << theirs << ',' << ours / theirs << '\n';
    is_fast = is_fast && ours / theirs < kMostRatio;
  }
  return is_fast ? 0 : 1;
}
