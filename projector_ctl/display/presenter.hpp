/// Shows pictures while the bus loop continues.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "projector_ctl/display/screen.hpp"

namespace lab::projector {

/// Executes one job at a time; its result is polled.
class Presenter {
 public:
  Presenter() = default;
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;
  virtual ~Presenter() = default;

  /// The state of the screen after it was opened.
  [[nodiscard]] virtual const ScreenState& opened() const = 0;

  virtual void submit(ScreenJob job) = 0;

  /// Returns the result of the last job once; empty while it is in progress.
  virtual std::optional<ScreenResult> poll() = 0;
};

/// Runs the screen in its own thread, so that the bus loop does not wait for swaps or large
/// pictures.
class ThreadPresenter final : public Presenter {
 public:
  static constexpr std::chrono::seconds kShutdownTimeout{2};  ///< for the last swap

  /// Opens the screen. @throws what Screen::open() throws.
  explicit ThreadPresenter(Screen::Setup setup);

  /// Shows the safe field and closes the screen. If the display does not answer within
  /// kShutdownTimeout, this is reported on stderr and the thread is abandoned: it blocks as soon as
  /// the display answers, and at exit the process skips exit handlers and static destructors, which
  /// could wait for the thread.
  ~ThreadPresenter() override;

  [[nodiscard]] const ScreenState& opened() const override { return opened_; }
  void submit(ScreenJob job) override;
  std::optional<ScreenResult> poll() override;

 private:
  /// Data of both threads. An abandoned thread may use them after the presenter is destroyed.
  struct Shared {
    std::mutex mutex{};
    std::condition_variable changed{};
    std::optional<ScreenJob> job{};
    std::optional<ScreenResult> result{};
    std::optional<ScreenState> opened{};  ///< or `failure`
    std::exception_ptr failure{};
    bool ends = false;       ///< the thread is to end
    bool ended = false;      ///< the screen is closed
    bool abandoned = false;  ///< the caller and its objects no longer exist

    /// Blocks the calling thread for ever if it was abandoned. @param lock on `mutex`
    void parkThread(std::unique_lock<std::mutex>& lock);
  };

  static void work(Shared& shared, Screen::Setup setup);

  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  ScreenState opened_;
  std::thread thread_;
};

/// Executes jobs at once in the caller's thread, for virtual time.
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
