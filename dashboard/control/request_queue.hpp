/// From the threads of a web server into the lab's loop, and back.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "dashboard/control/lab_request_handler.hpp"

namespace lab::dashboard {

/// What is asked waits until the loop serves it, at most a second: then it is withdrawn, so that
/// nothing is done that was said to be refused. No wish waits behind more than one question: a stop
/// may be among them.
class RequestQueue final : public LabRequestHandler {
 public:
  struct Answers {
    std::function<std::string(const OperatorRequest&)> wish;
    std::function<std::optional<std::string>(std::string_view what, std::string_view which)> ask;
  };

  static constexpr std::size_t kMostWaiting = 200;  ///< wishes, and as many questions

  /// @param answers called by serve() alone
  /// @throws std::system_error when the machine has no descriptor left
  explicit RequestQueue(Answers answers,
                        std::chrono::milliseconds patience = std::chrono::seconds(1));
  ~RequestQueue() override;

  [[nodiscard]] std::string wish(const OperatorRequest& wish) override;
  [[nodiscard]] std::optional<std::string> ask(std::string_view what,
                                               std::string_view which) override;

  /// Readable while somebody waits.
  [[nodiscard]] int descriptor() const { return descriptor_; }

  /// Does all wishes and answers one question; the descriptor stays readable while others wait, so
  /// that the loop does its other work between. For the loop.
  void serve();

  /// Nobody is answered any more: who waits is refused at once.
  void close();

 private:
  struct PendingRequest;
  using Queue = std::deque<std::shared_ptr<PendingRequest>>;

  /// @return whether it was done.
  bool run(Queue& queue, std::function<void()> work);
  bool ring() const;

  Answers answers_;
  std::chrono::milliseconds patience_;
  int descriptor_;
  std::mutex mutex_;
  bool closed_ = false;
  Queue requests_;
  Queue questions_;
};

}  // namespace lab::dashboard
