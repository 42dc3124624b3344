/// Parses operator requests from JSON.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "dashboard/control/operator_request.hpp"

namespace lab::dashboard {

/// Says what was found in an invalid request and what was expected.
struct InvalidRequest {
  std::string why;
};

/// Parses {"request": NAME, ...} (docs/dashboard.md); the former key "wish" is accepted too. A
/// request with a key that is missing, unknown, of the wrong type or out of range is invalid;
/// nothing is corrected. The only exception is the reason of a stop, since a stop must never fail.
[[nodiscard]] std::variant<OperatorRequest, InvalidRequest> readOperatorRequest(
    std::string_view json);

}  // namespace lab::dashboard
