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
class WishDesk {
 public:
  /// Does what is wished. @return why it is refused, empty: it is done.
  using Obey = std::function<std::string(const experiment_command_t&)>;

  explicit WishDesk(Obey obey) : obey_(std::move(obey)) {}

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

  Obey obey_;
  std::deque<Answer> answers_;  ///< the newest last
};

}  // namespace lab::runner
