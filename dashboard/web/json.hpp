/// Helpers for JSON that is sent to the page.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "common/math/units.hpp"
#include "common/text/json_number.hpp"

namespace lab::dashboard {

using Json = nlohmann::ordered_json;

using lab::number;

/// Each of the values times `factor`.
template <class Values>
[[nodiscard]] Json numbers(const Values& values, double factor) {
  Json out = Json::array();
  for (const auto value : values) out.push_back(number(static_cast<double>(value) * factor));
  return out;
}

/// A time [us since 1970]; null if it is 0, which means unknown.
[[nodiscard]] inline Json timeOrNull(std::int64_t utime) {
  return utime == 0 ? Json() : Json(utime);
}

/// Seconds from `then` to `now`; null if `then` is 0, which means never.
[[nodiscard]] inline Json age(std::int64_t then, std::int64_t now) {
  return then == 0 ? Json() : number(units::seconds(now - then));
}

/// Converts m to cm.
[[nodiscard]] constexpr double cm(double metres) { return metres / units::kCentimetre; }

/// Serializes a document. Invalid UTF-8 is replaced, because texts come from the bus.
[[nodiscard]] inline std::string toText(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lab::dashboard
