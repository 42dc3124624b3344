/// What a web server may ask of the lab behind it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "dashboard/control/operator_request.hpp"

namespace lab::dashboard {

/// Called from the threads of a server, answered by the lab's own.
class LabRequestHandler {
 public:
  LabRequestHandler() = default;
  LabRequestHandler(const LabRequestHandler&) = delete;
  LabRequestHandler& operator=(const LabRequestHandler&) = delete;
  virtual ~LabRequestHandler() = default;

  /// Takes a wish. What became of it is told by the topics (docs/dashboard.md).
  /// @return why it is refused, empty: it is taken.
  [[nodiscard]] virtual std::string wish(const OperatorRequest& wish) = 0;

  /// JSON that is made only when somebody asks.
  /// @param what "analysis", "trails", "robot" ...
  /// @param which robot, program ...; may be empty
  /// @return nothing: there is no such thing, or the lab does not answer.
  [[nodiscard]] virtual std::optional<std::string> ask(std::string_view what,
                                                       std::string_view which) = 0;
};

}  // namespace lab::dashboard
