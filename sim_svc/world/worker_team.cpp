#include "sim_svc/world/worker_team.hpp"

#include <sched.h>

#include <algorithm>

namespace lab::sim {
namespace {

// A step of some thousand robots takes less time than waking a thread. Threads therefore look for
// the next task for a while before they sleep.
constexpr int kLooks = 2000;

constexpr int kPartBits = 32;

template <class Changed>
bool lookFor(const Changed& changed) {
  for (int look = 0; look < kLooks; ++look) {
    if (changed()) return true;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  return false;
}

}  // namespace

WorkerTeam::WorkerTeam(std::size_t threads) {
  for (std::size_t worker = 1; worker < threads; ++worker) {
    threads_.emplace_back([this, worker] { work(worker); });
  }
}

WorkerTeam::~WorkerTeam() {
  ending_ = true;
  ++round_;
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerTeam::run(std::size_t parts, const Task& task) {
  if (threads_.empty() || parts <= 1) {
    for (std::size_t part = 0; part < parts; ++part) task(part, 0);
    return;
  }
  task_ = &task;
  done_ = 0;
  ticket_ = std::uint64_t{parts} << kPartBits;
  ++round_;
  round_.notify_all();
  takeParts(0);
  lookFor([&] { return done_ == parts; });
  for (std::uint64_t done = done_; done < parts; done = done_) done_.wait(done);
}

void WorkerTeam::takeParts(std::size_t worker) {
  std::uint64_t ticket = ticket_;
  for (;;) {
    const std::uint64_t parts = ticket >> kPartBits;
    const std::uint64_t part = ticket & ((std::uint64_t{1} << kPartBits) - 1);
    if (part == parts) return;
    if (!ticket_.compare_exchange_weak(ticket, ticket + 1)) continue;
    (*task_)(part, worker);
    if (++done_ == parts) {
      done_.notify_one();
      return;
    }
    ticket = ticket_;
  }
}

void WorkerTeam::work(std::size_t worker) {
  std::uint32_t seen = 0;
  for (;;) {
    lookFor([&] { return round_ != seen; });
    round_.wait(seen);
    seen = round_;
    if (ending_) return;
    takeParts(worker);
  }
}

std::size_t availableProcessors() {
  cpu_set_t processors;
  CPU_ZERO(&processors);
  if (sched_getaffinity(0, sizeof processors, &processors) != 0) return 1;
  return static_cast<std::size_t>(std::max(1, CPU_COUNT(&processors)));
}

}  // namespace lab::sim
