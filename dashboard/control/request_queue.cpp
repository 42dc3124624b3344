#include "dashboard/control/request_queue.hpp"

#include <condition_variable>
#include <utility>

namespace lab::dashboard {

/// One entry of a queue, shared by the waiting thread and the loop. The loop claims it before it
/// does the work; the waiting thread can withdraw it only until then.
struct RequestQueue::PendingRequest {
  enum class State { kWaiting, kClaimed, kDone, kWithdrawn };

  explicit PendingRequest(std::function<void()> w) : work(std::move(w)) {}

  void execute() {
    {
      const std::lock_guard lock(mutex);
      if (state != State::kWaiting) return;
      state = State::kClaimed;
    }
    try {
      work();
    } catch (...) {
      set(State::kWithdrawn);
      throw;
    }
    set(State::kDone);
  }

  void withdraw() {
    const std::lock_guard lock(mutex);
    if (state == State::kWaiting) state = State::kWithdrawn;
    changed.notify_all();
  }

  bool wait(std::chrono::milliseconds timeout) {
    std::unique_lock lock(mutex);
    const auto over = [this] { return state == State::kDone || state == State::kWithdrawn; };
    if (changed.wait_for(lock, timeout, over)) return state == State::kDone;
    if (state == State::kWaiting) {
      state = State::kWithdrawn;
      return false;
    }
    changed.wait(lock, over);  // the loop is doing the work
    return state == State::kDone;
  }

  bool isWithdrawn() {
    const std::lock_guard lock(mutex);
    return state == State::kWithdrawn;
  }

  void set(State next) {
    const std::lock_guard lock(mutex);
    state = next;
    changed.notify_all();
  }

  std::function<void()> work;
  std::mutex mutex;
  std::condition_variable changed;
  State state = State::kWaiting;
};

RequestQueue::RequestQueue(Handlers handlers, std::chrono::milliseconds timeout)
    : handlers_(std::move(handlers)), timeout_(timeout) {}

RequestQueue::~RequestQueue() { close(); }

bool RequestQueue::run(Queue& queue, std::function<void()> work) {
  const auto pending = std::make_shared<PendingRequest>(std::move(work));
  {
    const std::lock_guard lock(mutex_);
    // Withdrawn entries do not count.
    std::erase_if(queue, [](const auto& waiting) { return waiting->isWithdrawn(); });
    if (closed_ || queue.size() >= kMaxPending) return false;
    queue.push_back(pending);
    pending_.signal();
  }
  return pending->wait(timeout_);
}

std::string RequestQueue::request(const OperatorRequest& request) {
  std::string refusal;
  const bool done = run(requests_, [&] { refusal = handlers_.request(request); });
  return done ? refusal : "the lab's loop does not answer; nothing was done";
}

std::optional<std::string> RequestQueue::query(std::string_view what, std::string_view which) {
  std::optional<std::string> answer;
  const bool done = run(queries_, [&] { answer = handlers_.query(what, which); });
  return done ? answer : std::nullopt;
}

void RequestQueue::serve() {
  Queue claimed;
  {
    const std::lock_guard lock(mutex_);
    pending_.clear();
    claimed.swap(requests_);
    if (!queries_.empty()) {
      claimed.push_back(std::move(queries_.front()));
      queries_.pop_front();
    }
    if (!queries_.empty()) pending_.signal();
  }
  for (const auto& pending : claimed) pending->execute();
}

void RequestQueue::close() {
  Queue claimed;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    claimed.swap(requests_);
    claimed.insert(claimed.end(), queries_.begin(), queries_.end());
    queries_.clear();
  }
  for (const auto& pending : claimed) pending->withdraw();
}

}  // namespace lab::dashboard
