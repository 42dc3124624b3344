/// Who shows pictures while the bus loop goes on.
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
  static constexpr std::chrono::seconds kShutdownTimeout{2};  ///< for a swap, at the end

  /// Opens the screen. @throws what Screen::open() throws.
  explicit ThreadPresenter(Screen::Setup setup);

  /// Shows the safe field and closes. A display that does not let go within kShutdownTimeout is
  /// left: it is said on stderr, the thread stands still as soon as it comes back, and the process,
  /// once it exits, leaves without the handlers and static destructors that could wait for the
  /// thread.
  ~ThreadPresenter() override;

  [[nodiscard]] const ScreenState& opened() const override { return opened_; }
  void submit(ScreenJob job) override;
  std::optional<ScreenResult> poll() override;

 private:
  /// What both threads use; the one that is left behind may use it for longer than the presenter
  /// lives.
  struct Shared {
    std::mutex mutex{};
    std::condition_variable changed{};
    std::optional<ScreenJob> job{};
    std::optional<ScreenResult> result{};
    std::optional<ScreenState> opened{};  ///< or `failure`
    std::exception_ptr failure{};
    bool ends = false;       ///< the thread is to
    bool ended = false;      ///< the screen is closed
    bool abandoned = false;  ///< nobody waits for the thread, and nothing of the caller's is left

    /// The calling thread goes no further once it is abandoned. @param lock on `mutex`
    void parkThread(std::unique_lock<std::mutex>& lock);
  };

  static void work(Shared& shared, Screen::Setup setup);

  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  ScreenState opened_;
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
