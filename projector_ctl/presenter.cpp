#include "projector_ctl/presenter.hpp"

#include <exception>
#include <utility>

namespace lab::projector {

ThreadPresenter::ThreadPresenter(Screen::Setup setup) {
  std::exception_ptr failure;
  bool done = false;
  thread_ = std::thread([&, setup = std::move(setup)]() mutable {
    work(std::move(setup), failure, done);
  });
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return done; });
  lock.unlock();
  if (!failure) return;
  thread_.join();
  std::rethrow_exception(failure);
}

ThreadPresenter::~ThreadPresenter() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ThreadPresenter::submit(ScreenJob job) {
  {
    const std::lock_guard lock(mutex_);
    job_ = std::move(job);
  }
  changed_.notify_all();
}

std::optional<ScreenResult> ThreadPresenter::poll() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, std::nullopt);
}

void ThreadPresenter::work(Screen::Setup setup, std::exception_ptr& failure, bool& done) {
  Screen screen(std::move(setup));
  bool works = true;
  {
    std::exception_ptr problem;
    try {
      screen.open();
    } catch (...) {
      problem = std::current_exception();
      works = false;
    }
    const std::lock_guard lock(mutex_);
    failure = problem;
    opened_ = screen.state();
    done = true;
    changed_.notify_all();  // under the lock: what it refers to ends with the constructor
  }
  while (works) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ends_ || job_; });
    if (ends_) return;
    const ScreenJob job = *std::exchange(job_, std::nullopt);
    lock.unlock();
    ScreenResult result = screen.run(job);
    lock.lock();
    result_ = std::move(result);
  }
}

}  // namespace lab::projector
