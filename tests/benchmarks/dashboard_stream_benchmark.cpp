// Cost of the dashboard's event stream: CPU time and bytes for no, one and ten clients, at 20
// frames per second of 100 robots. The clients are another process.
#include <arpa/inet.h>
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "dashboard/web/web_server.hpp"

namespace {

using namespace lab::dashboard;
using namespace std::chrono_literals;

constexpr int kFrames = 100;
constexpr int kRobots = 100;
constexpr auto kPeriod = 50ms;

struct NoLab final : LabRequestHandler {
  std::string wish(const OperatorRequest&) override { return {}; }
  std::optional<std::string> ask(std::string_view, std::string_view) override { return {}; }
};

std::string frame(int number) {
  std::string text =
      fmt::format("{{\"t_us\":{},\"robots\":[", 1'800'000'000'000'000 + number * 50'000);
  for (int id = 1; id <= kRobots; ++id) {
    const double way = 0.01 * number + id;
    text += fmt::format("{}[{},{:.3f},{:.3f},{:.2f},{},0,2,0.98,0.031]", id > 1 ? "," : "", id,
                        60 + way, 45 - way, 17 * way, id % 4);
  }
  return text + "],\"unidentified\":[]}";
}

int connectTo(int port) {
  const int client = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(port));
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(client, reinterpret_cast<sockaddr*>(&place), sizeof place) != 0) _exit(1);
  const std::string ask =
      fmt::format("GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", port);
  if (write(client, ask.data(), ask.size()) < 0) _exit(1);
  return client;
}

/// Runs in its own process: reads until the server ends, then reports the number of bytes.
[[noreturn]] void look(int viewers, int from_server, int to_server) {
  int port = 0;
  if (read(from_server, &port, sizeof port) != sizeof port) _exit(1);
  std::vector<pollfd> clients;
  for (int i = 0; i < viewers; ++i) clients.push_back({connectTo(port), POLLIN, 0});
  std::array<char, 65536> piece{};
  std::int64_t bytes = 0;
  for (int open = viewers; open > 0;) {
    poll(clients.data(), clients.size(), -1);
    for (pollfd& client : clients) {
      if (client.fd < 0 || client.revents == 0) continue;
      const ssize_t count = read(client.fd, piece.data(), piece.size());
      if (count > 0) {
        bytes += count;
      } else {
        close(client.fd);
        client.fd = -1;
        --open;
      }
    }
  }
  _exit(write(to_server, &bytes, sizeof bytes) == sizeof bytes ? 0 : 1);
}

/// CPU time of this process so far [s].
double processorTime() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void streams(benchmark::State& state) {
  static double one_viewer = 0;
  const int viewers = static_cast<int>(state.range(0));
  for (auto _ : state) {
    std::array<int, 2> down{};
    std::array<int, 2> up{};
    if (pipe(down.data()) != 0 || pipe(up.data()) != 0) return state.SkipWithError("no pipe");
    const pid_t child = fork();
    if (child == 0) look(viewers, down[0], up[1]);
    Hub hub;
    NoLab lab;
    WebOptions options;
    options.port = 0;
    std::optional<WebServer> server(std::in_place, options, hub, lab);
    const int port = server->port();
    if (write(down[1], &port, sizeof port) != sizeof port) return state.SkipWithError("no child");
    while (server->viewers() < viewers) std::this_thread::sleep_for(1ms);
    const double before = processorTime();
    auto next = std::chrono::steady_clock::now();
    for (int i = 0; i < kFrames; ++i) {
      hub.publish("frame", frame(i));
      std::this_thread::sleep_until(next += kPeriod);
    }
    const double used = processorTime() - before;
    server.reset();
    std::int64_t bytes = 0;
    if (read(up[0], &bytes, sizeof bytes) != sizeof bytes) bytes = -1;
    waitpid(child, nullptr, 0);
    for (const int end : {down[0], down[1], up[0], up[1]}) close(end);
    if (viewers == 1) one_viewer = used;
    const double length = kFrames * std::chrono::duration<double>(kPeriod).count();
    state.counters["percent_of_a_core"] = 100 * used / length;
    state.counters["kB_per_s"] = static_cast<double>(bytes) / 1e3 / length;
    if (one_viewer > 0) state.counters["over_one_viewer"] = used / one_viewer;
  }
}
BENCHMARK(streams)->Arg(0)->Arg(1)->Arg(10)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
