/// Latency and CPU of the link between hosts, compared with plain LCM in the same run.
///   tests/two_hosts.sh --hosts 3 link_benchmark RESULTS.csv
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <lab/light_command_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "common/math/percentiles.hpp"
#include "tests/support/network_hosts.hpp"

namespace lab::gateway {
namespace {

using Make = std::function<std::vector<std::uint8_t>(std::int64_t seq)>;

struct Load {
  const char* name;
  double rate;  ///< [1/s]
  std::string_view channel;
  Make make;
};

constexpr double kSeconds = 10;
constexpr const char* kSender = "load";

std::vector<std::uint8_t> small(std::int64_t seq) {
  light_command_t command{};
  command.label.assign(95, 'x');  // 200 B in total
  return message(kSender, seq, command);
}

/// A frame with 20 robots.
std::vector<std::uint8_t> lab(std::int64_t seq) {
  tracked_frame_t frame{};
  frame.num_robots = seq % 5 == 0 ? 20 : 3;
  frame.robots.resize(static_cast<std::size_t>(frame.num_robots));
  return message(kSender, seq, frame);
}

/// @return CPU time of a process [s]
double processorSeconds(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0;
  double system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// Publishes on a host's bus from its own thread, as another process would.
std::vector<double> publish(const Host& host, const Load& load) {
  const NetworkNamespaceScope there(host.process);
  LcmBus bus(kUrl);
  std::vector<double> sent;
  const double start = steadySeconds();
  const int count = static_cast<int>(load.rate * kSeconds);
  for (int i = 0; i < count; ++i) {
    const double left = start + i / load.rate - steadySeconds();
    if (left > 0) std::this_thread::sleep_for(std::chrono::duration<double>(left));
    const auto bytes = load.make(i + 1);
    sent.push_back(steadySeconds());
    bus.publish(load.channel, bytes);
  }
  return sent;
}

Percentiles delays(const Host& host, const Load& load, const std::vector<double>& sent) {
  std::vector<double> micro;
  for (const Message& message : host.of(kSender, load.channel)) {
    micro.push_back(1e6 * (message.came - sent[static_cast<std::size_t>(message.seq - 1)]));
  }
  return percentilesOf(micro);
}

void measure(Hosts& hosts, const Program& a, const Program& b, const Load& load,
             std::ofstream& results) {
  for (std::size_t host = 0; host < 3; ++host) hosts[host].heard.clear();
  const double start = steadySeconds();
  const double cpu_a = processorSeconds(a.id());
  const double cpu_b = processorSeconds(b.id());
  std::atomic<bool> done = false;
  std::vector<double> sent;
  std::thread publisher([&] {
    sent = publish(hosts[0], load);
    done = true;
  });
  hosts.until([&done] { return done.load(); }, 3 * kSeconds);
  publisher.join();
  hosts.run(0.5);
  const double seconds = steadySeconds() - start;
  const double share_a = 100 * (processorSeconds(a.id()) - cpu_a) / seconds;
  const double share_b = 100 * (processorSeconds(b.id()) - cpu_b) / seconds;
  const Percentiles plain = delays(hosts[0], load, sent);
  const Percentiles link = delays(hosts[1], load, sent);
  std::printf(
      "%-28s %5zu B: plain LCM %5zu, p50 %4.0f p95 %4.0f p99 %5.0f us; link %5zu of %5zu, "
      "p50 %4.0f p95 %4.0f p99 %5.0f max %6.0f us; ratio of p50 %.1f; gateways %.1f and "
      "%.1f %% of a core, %.0f and %.0f MB; timeouts %ld\n",
      load.name, load.make(1).size(), plain.count, plain.p50, plain.p95, plain.p99, link.count,
      sent.size(), link.p50, link.p95, link.p99, link.max, link.p50 / plain.p50, share_a, share_b,
      a.megabytes(), b.megabytes(), hosts[0].status.timeouts);
  results << load.name << ',' << load.make(1).size() << ',' << sent.size() << ',' << plain.count
          << ',' << plain.p50 << ',' << plain.p95 << ',' << plain.p99 << ',' << link.count << ','
          << link.p50 << ',' << link.p95 << ',' << link.p99 << ',' << link.max << ',' << share_a
          << ',' << share_b << ',' << a.megabytes() << '\n';
}

int run(const char* file) {
  std::ofstream results(file);
  results << "case,bytes,sent,plain_received,plain_p50_us,plain_p95_us,plain_p99_us,link_received,"
             "link_p50_us,link_p95_us,link_p99_us,link_max_us,sender_cpu_percent,"
             "receiver_cpu_percent,sender_rss_mb\n";
  Hosts hosts({"A", "B", "C"});
  const auto a = hosts.gateway(0);
  const auto b = hosts.gateway(1);
  const auto c = hosts.gateway(2);
  if (!hosts.untilState(link_peer_t::JOINED, 2, 20)) {
    std::fprintf(stderr, "link_benchmark: the buses of the hosts are not joined\n");
    return 1;
  }
  measure(hosts, *a, *b, {"idle", 1, channels::kLightCommand, small}, results);
  measure(hosts, *a, *b, {"small, 1 kHz", 1000, channels::kLightCommand, small}, results);
  measure(hosts, *a, *b, {"20 robots, 250 Hz", 250, channels::kTrackedFrame, lab}, results);
  c->signal(SIGSTOP);
  measure(hosts, *a, *b, {"1 kHz, the third host frozen", 1000, channels::kLightCommand, small},
          results);
  c->signal(SIGCONT);
  hosts.run(2);
  return 0;
}

}  // namespace
}  // namespace lab::gateway

int main(int argc, char** argv) {
  if (argc != 2 || !lab::gateway::hostsAreThere()) {
    std::fprintf(stderr, "usage: tests/two_hosts.sh --hosts 3 link_benchmark RESULTS.csv\n");
    return 2;
  }
  return lab::gateway::run(argv[1]);
}
