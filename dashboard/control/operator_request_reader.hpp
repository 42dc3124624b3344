/// A wish from the page's words.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "dashboard/control/operator_request.hpp"

namespace lab::dashboard {

/// What is wrong with a text, and what was expected.
struct InvalidRequest {
  std::string why;
};

/// {"wish": NAME, ...} of docs/dashboard.md. Nothing may be missing, unknown, of another type or
/// out of range; nothing is repaired.
[[nodiscard]] std::variant<OperatorRequest, InvalidRequest> readOperatorRequest(
    std::string_view json);

}  // namespace lab::dashboard
