/// JSON texts that may come from others.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace lab {

/// More than any file of the lab has.
constexpr int kDeepestJson = 64;

/// Whether more than `depth` arrays and objects lie within each other.
[[nodiscard]] bool isNestedDeeper(std::string_view json, int depth);

/// Parses a text. nlohmann::json copies and prints nested values by recursion, so that a text of a
/// million brackets would overflow the stack.
/// @return a discarded value if the text is no JSON or is nested deeper than kDeepestJson
template <class Json = nlohmann::json>
[[nodiscard]] Json parseJsonText(std::string_view text) {
  if (isNestedDeeper(text, kDeepestJson)) return Json(Json::value_t::discarded);
  return Json::parse(text, nullptr, false);
}

}  // namespace lab
