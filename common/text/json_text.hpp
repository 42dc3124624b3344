/// JSON texts that may come from others.
#pragma once

#include <concepts>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

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

/// A whole number within limits. nlohmann::json also converts fractions and larger numbers; of
/// numbers like 1e300 that is undefined.
/// @throws std::out_of_range
template <std::integral Integer, class Json>
[[nodiscard]] Integer wholeNumber(const Json& json, Integer low, Integer high) {
  if (json.is_number_unsigned()) {
    const auto value = json.template get<std::uint64_t>();
    if (std::cmp_less_equal(low, value) && std::cmp_less_equal(value, high)) {
      return static_cast<Integer>(value);
    }
  } else if (json.is_number_integer()) {
    const auto value = json.template get<std::int64_t>();
    if (std::cmp_less_equal(low, value) && std::cmp_less_equal(value, high)) {
      return static_cast<Integer>(value);
    }
  }
  throw std::out_of_range("expected a whole number from " + std::to_string(low) + " to " +
                          std::to_string(high));
}

}  // namespace lab
