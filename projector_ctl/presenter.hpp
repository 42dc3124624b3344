/// Who shows pictures while the bus loop goes on.
#pragma once

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "projector_ctl/screen.hpp"

namespace lab::projector {

/// Takes one job at a time, and is asked for what became of it.
class Presenter {
 public:
  Presenter() = default;
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;
  virtual ~Presenter() = default;

  /// Of the screen when it had been opened.
  [[nodiscard]] virtual const ScreenState& opened() const = 0;

  virtual void submit(ScreenJob job) = 0;

  /// The result of the job submitted last, once; nothing while it is under way.
  virtual std::optional<ScreenResult> poll() = 0;
};

/// In a thread of its own, which alone touches the screen: a swap that waits for the display, or a
/// large picture, must not keep the bus waiting.
class ThreadPresenter final : public Presenter {
 public:
  /// Opens the screen. @throws what Screen::open() throws.
  explicit ThreadPresenter(Screen::Setup setup);

  /// Shows the safe field and closes.
  ~ThreadPresenter() override;

  [[nodiscard]] const ScreenState& opened() const override { return opened_; }
  void submit(ScreenJob job) override;
  std::optional<ScreenResult> poll() override;

 private:
  void work(Screen::Setup setup, std::exception_ptr& failure, bool& done);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<ScreenJob> job_;
  std::optional<ScreenResult> result_;
  ScreenState opened_;
  bool ends_ = false;
  std::thread thread_;
};

/// At once, in the caller's thread: for virtual time.
class InlinePresenter final : public Presenter {
 public:
  explicit InlinePresenter(Screen::Setup setup) : screen_(std::move(setup)) {
    screen_.open();
    opened_ = screen_.state();
  }
  [[nodiscard]] const ScreenState& opened() const override { return opened_; }
  void submit(ScreenJob job) override { result_ = screen_.run(job); }
  std::optional<ScreenResult> poll() override { return std::exchange(result_, std::nullopt); }

 private:
  Screen screen_;
  ScreenState opened_;
  std::optional<ScreenResult> result_;
};

}  // namespace lab::projector
