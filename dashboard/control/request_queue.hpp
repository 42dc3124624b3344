/// Passes requests from the threads of the web server to the loop of the service, and the results
/// back.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "common/process/event_descriptor.hpp"
#include "dashboard/control/lab_request_handler.hpp"

namespace lab::dashboard {

/// A request waits until the loop serves it. After the timeout (1 s) it is withdrawn and refused,
/// so that nothing happens that was reported as refused. At most one query is answered before a
/// waiting request, because the request may be a stop.
class RequestQueue final : public LabRequestHandler {
 public:
  struct Handlers {
    std::function<std::string(const OperatorRequest&)> request;
    std::function<std::optional<std::string>(std::string_view what, std::string_view which)> query;
  };

  static constexpr std::size_t kMaxPending = 200;  ///< requests, and as many queries

  /// @param handlers are only called by serve()
  /// @throws std::system_error if no file descriptor is available
  explicit RequestQueue(Handlers handlers,
                        std::chrono::milliseconds timeout = std::chrono::seconds(1));
  ~RequestQueue() override;

  [[nodiscard]] std::string request(const OperatorRequest& request) override;
  [[nodiscard]] std::optional<std::string> query(std::string_view what,
                                                 std::string_view which) override;

  /// Is readable while something is pending.
  [[nodiscard]] int descriptor() const { return pending_.get(); }

  /// Handles all pending requests and one query. The descriptor stays readable while more queries
  /// wait, so that the loop can do other work in between. Call it on the loop's thread.
  void serve();

  /// Refuses everything that is pending, and everything from now on, at once.
  void close();

 private:
  struct PendingRequest;
  using Queue = std::deque<std::shared_ptr<PendingRequest>>;

  /// @return whether the work was done
  bool run(Queue& queue, std::function<void()> work);

  Handlers handlers_;
  std::chrono::milliseconds timeout_;
  EventDescriptor pending_;
  std::mutex mutex_;
  bool closed_ = false;
  Queue requests_;
  Queue queries_;
};

}  // namespace lab::dashboard
