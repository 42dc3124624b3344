/// The interface through which the web server reaches the lab.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "dashboard/control/operator_request.hpp"

namespace lab::dashboard {

/// Called on the threads of the web server; implementations pass the calls to the thread of the
/// service's loop.
class LabRequestHandler {
 public:
  LabRequestHandler() = default;
  LabRequestHandler(const LabRequestHandler&) = delete;
  LabRequestHandler& operator=(const LabRequestHandler&) = delete;
  virtual ~LabRequestHandler() = default;

  /// Accepts a request of the operator. The topics then show its effect (docs/dashboard.md).
  /// @return why it is refused; empty if it is accepted
  [[nodiscard]] virtual std::string request(const OperatorRequest& request) = 0;

  /// Returns JSON that is only made on demand.
  /// @param what "analysis", "trails", "robot" or "speeds"
  /// @param which the robot's id; may be empty
  /// @return nothing if it does not exist or the loop does not answer in time
  [[nodiscard]] virtual std::optional<std::string> query(std::string_view what,
                                                         std::string_view which) = 0;
};

}  // namespace lab::dashboard
