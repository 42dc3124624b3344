#include "common/loop/asio_loop.hpp"

#include <asio.hpp>
#include <chrono>
#include <cstdint>
#include <list>
#include <utility>

#include "common/loop/wall_clock.hpp"

namespace lab {
namespace {

using Steady = std::chrono::steady_clock;
using Microseconds = std::chrono::microseconds;

std::int64_t inMicroseconds(Steady::time_point time) {
  return std::chrono::duration_cast<Microseconds>(time.time_since_epoch()).count();
}

struct Repeating {
  Repeating(asio::io_context& io, std::int64_t period, std::int64_t first, Loop::Callback call)
      : timer(io), period_us(period), next_utime(first), callback(std::move(call)) {}
  asio::steady_timer timer;
  std::int64_t period_us;
  std::int64_t next_utime;
  Loop::Callback callback;
};

/// Shared with the pending wait, because a callback may end its own watch.
struct Watched {
  Watched(asio::io_context& io, int fd, Loop::Callback call)
      : descriptor(io, fd), callback(std::move(call)) {}
  asio::posix::stream_descriptor descriptor;
  Loop::Callback callback;
};

class DescriptorWatch final : public DescriptorWatcher::Watch {
 public:
  explicit DescriptorWatch(std::shared_ptr<Watched> watched) : watched_(std::move(watched)) {}
  ~DescriptorWatch() override { watched_->descriptor.release(); }

 private:
  std::shared_ptr<Watched> watched_;
};

void waitFor(const std::shared_ptr<Watched>& entry) {
  entry->descriptor.async_wait(asio::posix::stream_descriptor::wait_read,
                               [entry](const asio::error_code& error) {
                                 if (error || !entry->descriptor.is_open()) return;
                                 entry->callback();
                                 if (entry->descriptor.is_open()) waitFor(entry);
                               });
}

struct Signals {
  explicit Signals(asio::io_context& io) : set(io) {}
  asio::signal_set set;
  std::function<void(int)> callback;
};

}  // namespace

struct AsioLoop::Implementation {
  asio::io_context io{1};
  Steady::time_point steady_start = Steady::now();
  std::int64_t wall_start = wallClock();
  std::list<Repeating> repeating;
  std::list<std::unique_ptr<Watch>> watched;
  std::list<Signals> signals;

  [[nodiscard]] Steady::time_point steadyTime(std::int64_t utime) const {
    return steady_start + Microseconds(utime - wall_start);
  }
  [[nodiscard]] std::int64_t now() const {
    return wall_start +
           std::chrono::duration_cast<Microseconds>(Steady::now() - steady_start).count();
  }

  void arm(Repeating& entry) {
    entry.timer.expires_at(steadyTime(entry.next_utime));
    entry.timer.async_wait([this, &entry](const asio::error_code& error) {
      if (error) return;
      entry.callback();
      const std::int64_t late = now() - entry.next_utime;
      entry.next_utime += entry.period_us * (late > 0 ? 1 + late / entry.period_us : 1);
      arm(entry);
    });
  }

  void listen(Signals& entry) {
    entry.set.async_wait([this, &entry](const asio::error_code& error, int signal) {
      if (error) return;
      entry.callback(signal);
      listen(entry);
    });
  }
};

AsioLoop::AsioLoop(std::optional<std::int64_t> clock_offset_us)
    : implementation_(std::make_unique<Implementation>()) {
  if (clock_offset_us) {
    implementation_->wall_start = inMicroseconds(implementation_->steady_start) + *clock_offset_us;
  }
}

AsioLoop::~AsioLoop() = default;

std::int64_t AsioLoop::now() const { return implementation_->now(); }

std::int64_t AsioLoop::clockOffset() const {
  return implementation_->wall_start - inMicroseconds(implementation_->steady_start);
}

void AsioLoop::at(std::int64_t utime, Callback callback) {
  if (utime <= now()) {  // timers that expired together would fire in any order
    asio::post(implementation_->io, std::move(callback));
    return;
  }
  auto timer = std::make_shared<asio::steady_timer>(implementation_->io);
  timer->expires_at(implementation_->steadyTime(utime));
  timer->async_wait([timer, callback = std::move(callback)](const asio::error_code& error) {
    if (!error) callback();
  });
}

void AsioLoop::every(std::int64_t period_us, std::int64_t first_utime, Callback callback) {
  checkPeriod(period_us);
  implementation_->repeating.emplace_back(implementation_->io, period_us, first_utime,
                                          std::move(callback));
  implementation_->arm(implementation_->repeating.back());
}

void AsioLoop::stop() { implementation_->io.stop(); }

void AsioLoop::onReadable(int descriptor, Callback callback) {
  implementation_->watched.push_back(watch(descriptor, std::move(callback)));
}

std::unique_ptr<AsioLoop::Watch> AsioLoop::watch(int descriptor, Callback callback) {
  auto entry = std::make_shared<Watched>(implementation_->io, descriptor, std::move(callback));
  waitFor(entry);
  return std::make_unique<DescriptorWatch>(std::move(entry));
}

void AsioLoop::onSignals(std::initializer_list<int> signals, std::function<void(int)> callback) {
  Signals& entry = implementation_->signals.emplace_back(implementation_->io);
  for (const int signal : signals) entry.set.add(signal);
  entry.callback = std::move(callback);
  implementation_->listen(entry);
}

void AsioLoop::run() {
  const auto keep_alive = asio::make_work_guard(implementation_->io);
  implementation_->io.restart();
  implementation_->io.run();
}

void AsioLoop::poll() {
  implementation_->io.restart();
  implementation_->io.poll();
}

}  // namespace lab
