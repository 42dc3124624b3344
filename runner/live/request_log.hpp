/// Answers to EXPERIMENT_COMMAND. Each request is executed once, however often it is repeated.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <string>
#include <utility>

namespace lab::runner {

/// Keeps the last answers. No bus, no clock.
class RequestLog {
 public:
  /// Executes a request. @return why it is refused; empty: executed
  using Handler = std::function<std::string(const experiment_command_t&)>;

  explicit RequestLog(Handler handler) : handler_(std::move(handler)) {}

  /// Executes a new request. A repeated one gets the same answer again.
  void take(const experiment_command_t& command);

  /// Fills in the last answer and the request that it belongs to.
  void write(experiment_status_t& status) const;

 private:
  struct Answer {
    std::string sender;
    std::int64_t instance = 0;
    std::int64_t seq = 0;
    std::string refusal;
  };

  Handler handler_;
  std::deque<Answer> answers_;  ///< newest last
};

}  // namespace lab::runner
