/// Threads that share the work of a step.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace lab::sim {

/// Threads that work on the parts of a task. The caller is one of them. Which thread works on which
/// part is left to chance, so a part must write only what belongs to it.
class WorkerTeam {
 public:
  /// A part of a task; `worker` (0 to size() - 1) tells whose scratch memory it may use.
  using Task = std::function<void(std::size_t part, std::size_t worker)>;

  /// @param threads 1 or more; with 1 the caller works alone
  explicit WorkerTeam(std::size_t threads);
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;
  ~WorkerTeam();

  /// Number of threads, with the caller.
  [[nodiscard]] std::size_t size() const { return threads_.size() + 1; }

  /// Calls task(part, worker) for the parts 0 to parts - 1 and returns when all are done. The task
  /// must not throw.
  void run(std::size_t parts, const Task& task);

 private:
  void work(std::size_t worker);
  void takeParts(std::size_t worker);

  // A thread takes a part by counting ticket_ up. Threads that come late find no part left, and
  // nobody waits for them.
  const Task* task_ = nullptr;
  std::atomic<std::uint64_t> ticket_{0};  ///< Number of parts, and of those taken.
  std::atomic<std::uint64_t> done_{0};    ///< Parts.
  std::atomic<std::uint32_t> round_{0};   ///< Counts the calls of run().
  std::atomic<bool> ending_{false};
  std::vector<std::thread> threads_;
};

/// The number of processors that this process may use, at least 1.
[[nodiscard]] std::size_t availableProcessors();

}  // namespace lab::sim
