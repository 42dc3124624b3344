/// Answers to EXPERIMENT_COMMAND: each wish is obeyed once, however often it is repeated.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <string>
#include <utility>

namespace lab::runner {

/// Keeps the last answers: no bus, no clock.
class RequestLog {
 public:
  /// Does what is wished. @return why it is refused, empty: it is done.
  using Handler = std::function<std::string(const experiment_command_t&)>;

  explicit RequestLog(Handler obey) : handler_(std::move(obey)) {}

  /// Obeys a wish that is new; answers one that is not as before.
  void take(const experiment_command_t& command);

  /// Fills in which wish was answered last, and how.
  void write(experiment_status_t& status) const;

 private:
  struct Answer {
    std::string sender;
    std::int64_t instance = 0;
    std::int64_t seq = 0;
    std::string refusal;
  };

  Handler handler_;
  std::deque<Answer> answers_;  ///< the newest last
};

}  // namespace lab::runner
