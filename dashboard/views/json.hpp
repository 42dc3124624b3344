/// JSON as the page gets it.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "common/math/units.hpp"
#include "common/text/json_number.hpp"

namespace lab::dashboard {

using Json = nlohmann::ordered_json;

/// Rounded to six figures; null where it is no number.
using lab::number;

/// A time of day, null where it is 0: not known.
[[nodiscard]] inline Json timeOrNull(std::int64_t utime) {
  return utime == 0 ? Json() : Json(utime);
}

/// Seconds since then; null where it never was.
[[nodiscard]] inline Json age(std::int64_t then, std::int64_t now) {
  return then == 0 ? Json() : number(units::seconds(now - then));
}

/// [cm]
[[nodiscard]] constexpr double cm(double metres) { return metres / units::kCentimetre; }

/// The text of a document. Strings come from the bus: what is no UTF-8 in them is replaced.
[[nodiscard]] inline std::string toText(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lab::dashboard
