#include "projector_ctl/display/presenter.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <utility>

namespace lab::projector {

ThreadPresenter::ThreadPresenter(Screen::Setup setup) {
  // The clock belongs to the caller. It may no longer exist when the thread was abandoned, so an
  // abandoned thread waits in parkThread() and does not call it.
  setup.now = [&shared = *shared_, now = std::move(setup.now)] {
    std::unique_lock lock(shared.mutex);
    shared.parkThread(lock);
    return now();
  };
  thread_ = std::thread(
      [shared = shared_, setup = std::move(setup)]() mutable { work(*shared, std::move(setup)); });
  std::unique_lock lock(shared_->mutex);
  shared_->changed.wait(lock, [this] { return shared_->opened || shared_->failure; });
  if (shared_->opened) {
    opened_ = *shared_->opened;
    return;
  }
  lock.unlock();
  thread_.join();
  std::rethrow_exception(shared_->failure);
}

ThreadPresenter::~ThreadPresenter() {
  std::unique_lock lock(shared_->mutex);
  shared_->ends = true;
  shared_->changed.notify_all();
  if (shared_->changed.wait_for(lock, kShutdownTimeout, [this] { return shared_->ended; })) {
    lock.unlock();
    thread_.join();
    return;
  }
  shared_->abandoned = true;
  thread_.detach();
  std::fprintf(stderr,
               "display %s: its last swap does not return; perhaps the safe field is not shown\n",
               opened_.name.c_str());
  // The exit handlers of a graphics driver wait for the driver's threads, which wait for the
  // display. _exit() ends the process without them.
  on_exit(
      [](int status, void*) {
        std::fflush(nullptr);
        _exit(status);
      },
      nullptr);
}

void ThreadPresenter::submit(ScreenJob job) {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->job = std::move(job);
  }
  shared_->changed.notify_all();
}

std::optional<ScreenResult> ThreadPresenter::poll() {
  const std::lock_guard lock(shared_->mutex);
  return std::exchange(shared_->result, std::nullopt);
}

void ThreadPresenter::Shared::parkThread(std::unique_lock<std::mutex>& lock) {
  while (abandoned) changed.wait(lock);
}

void ThreadPresenter::work(Shared& shared, Screen::Setup setup) {
  {
    Screen screen(std::move(setup));
    std::exception_ptr problem;
    try {
      screen.open();
    } catch (...) {
      problem = std::current_exception();
    }
    std::unique_lock lock(shared.mutex);
    if (problem) {
      shared.failure = problem;
      shared.changed.notify_all();
      return;
    }
    shared.opened = screen.state();
    shared.changed.notify_all();
    while (true) {
      shared.changed.wait(lock, [&] { return shared.ends || shared.job; });
      shared.parkThread(lock);
      if (shared.ends) break;
      const ScreenJob job = *std::exchange(shared.job, std::nullopt);
      lock.unlock();
      ScreenResult result = screen.run(job);
      lock.lock();
      shared.result = std::move(result);
    }
    lock.unlock();
  }
  const std::lock_guard lock(shared.mutex);
  shared.ended = true;
  shared.changed.notify_all();
}

}  // namespace lab::projector
