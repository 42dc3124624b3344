#include "dashboard/control/request_queue.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <cstdint>
#include <system_error>
#include <utility>

namespace lab::dashboard {

/// One who waits. The loop claims it, does it and says so; who has waited too long withdraws it,
/// unless it has been claimed.
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
      become(State::kWithdrawn);
      throw;
    }
    become(State::kDone);
  }

  void withdraw() {
    const std::lock_guard lock(mutex);
    if (state == State::kWaiting) state = State::kWithdrawn;
    changed.notify_all();
  }

  bool wait(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex);
    const auto over = [this] { return state == State::kDone || state == State::kWithdrawn; };
    if (changed.wait_for(lock, patience, over)) return state == State::kDone;
    if (state == State::kWaiting) {
      state = State::kWithdrawn;
      return false;
    }
    changed.wait(lock, over);  // it is being done
    return state == State::kDone;
  }

  bool isWithdrawn() {
    const std::lock_guard lock(mutex);
    return state == State::kWithdrawn;
  }

  void become(State next) {
    const std::lock_guard lock(mutex);
    state = next;
    changed.notify_all();
  }

  std::function<void()> work;
  std::mutex mutex;
  std::condition_variable changed;
  State state = State::kWaiting;
};

RequestQueue::RequestQueue(Answers answers, std::chrono::milliseconds patience)
    : answers_(std::move(answers)),
      patience_(patience),
      descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

RequestQueue::~RequestQueue() {
  close();
  ::close(descriptor_);
}

bool RequestQueue::ring() const {
  const std::uint64_t one = 1;
  return ::write(descriptor_, &one, sizeof one) == sizeof one || errno == EAGAIN;
}

bool RequestQueue::run(Queue& queue, std::function<void()> work) {
  const auto errand = std::make_shared<PendingRequest>(std::move(work));
  {
    const std::lock_guard lock(mutex_);
    // Who has given up waiting takes no place.
    std::erase_if(queue, [](const auto& waiting) { return waiting->isWithdrawn(); });
    if (closed_ || queue.size() >= kMostWaiting) return false;
    queue.push_back(errand);
    if (!ring()) return false;
  }
  return errand->wait(patience_);
}

std::string RequestQueue::wish(const OperatorRequest& wish) {
  std::string refusal;
  const bool done = run(requests_, [&] { refusal = answers_.wish(wish); });
  return done ? refusal : "the lab's loop does not answer; nothing was done";
}

std::optional<std::string> RequestQueue::ask(std::string_view what, std::string_view which) {
  std::optional<std::string> answer;
  const bool done = run(questions_, [&] { answer = answers_.ask(what, which); });
  return done ? answer : std::nullopt;
}

void RequestQueue::serve() {
  Queue errands;
  {
    const std::lock_guard lock(mutex_);
    std::uint64_t count = 0;
    if (::read(descriptor_, &count, sizeof count) < 0 && errno != EAGAIN) return;
    errands.swap(requests_);
    if (!questions_.empty()) {
      errands.push_back(std::move(questions_.front()));
      questions_.pop_front();
    }
    if (!questions_.empty()) ring();
  }
  for (const auto& errand : errands) errand->execute();
}

void RequestQueue::close() {
  Queue errands;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    errands.swap(requests_);
    errands.insert(errands.end(), questions_.begin(), questions_.end());
    questions_.clear();
  }
  for (const auto& errand : errands) errand->withdraw();
}

}  // namespace lab::dashboard
