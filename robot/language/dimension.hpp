#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lab::language {

/// The physical dimension of a number: exponents of length, time and voltage. Angles have none.
struct Dimension {
  int length = 0;
  int time = 0;
  int voltage = 0;

  bool operator==(const Dimension&) const = default;
};

constexpr Dimension kPure{};
constexpr Dimension kLength{1, 0, 0};
constexpr Dimension kTime{0, 1, 0};
constexpr Dimension kSpeed{1, -1, 0};
constexpr Dimension kRate{0, -1, 0};
constexpr Dimension kVoltage{0, 0, 1};

[[nodiscard]] Dimension product(const Dimension& a, const Dimension& b);
[[nodiscard]] Dimension quotient(const Dimension& a, const Dimension& b);

/// The dimension of a square root; nothing if an exponent is odd.
[[nodiscard]] std::optional<Dimension> squareRoot(const Dimension& a);

/// In the units of programs, as one writes them: "cm/s", "1/s", "cm^2/s"; "1" without dimension.
[[nodiscard]] std::string unitText(const Dimension& dimension);

/// A unit that texts of programs may use: its size in the units of programs (cm, s, rad, volt).
struct Unit {
  double size;
  Dimension dimension;
};

/// The unit with this name: m, cm, mm, um, s, ms, min, rad, deg, volt, percent. Nothing: no unit.
[[nodiscard]] std::optional<Unit> unitNamed(std::string_view name);

/// All names of units, for messages.
[[nodiscard]] std::string unitNames();

/// The end of a message about a name that stands where a unit could: "; write 1/s instead of Hz",
/// else ", which is no unit; units are ...".
[[nodiscard]] std::string unitAdvice(std::string_view name);

/// What to write instead of a unit that texts of programs do not have: "1/s" for "Hz"; empty: it
/// is no such unit.
[[nodiscard]] std::string_view otherUnit(std::string_view name);

}  // namespace lab::language
