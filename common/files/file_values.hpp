/// Values as written in an experiment file: numbers in the unit of the key's name, as short as
/// possible, and texts in quotes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lab::keys {

/// A unit of the file: SI value = file value * multiply / divide.
struct FileUnit {
  std::string_view suffix;  ///< the end of a key with this unit, "_cm_s"
  std::string_view text;    ///< for messages, "cm/s"
  double multiply = 1;
  double divide = 1;
};

/// The unit of a key by its name ("width_cm": centimetres); no conversion for a name without unit.
[[nodiscard]] const FileUnit& unitOf(std::string_view key);

[[nodiscard]] double toSi(double file_value, const FileUnit& unit);

/// Rounds to this many significant digits.
[[nodiscard]] double roundedToDigits(double value, int digits);

/// The shortest decimal that reads back as the same double; without exponent from 1e-5 to 1e15.
[[nodiscard]] std::string numberText(double value);

/// The shortest number that toSi() converts to exactly `si`, as text. If there is none, which
/// cannot happen for numbers read from a file, the nearest number.
[[nodiscard]] std::string fileText(double si, const FileUnit& unit);

/// A length in centimetres, "116.25". Rounded to 1e-9 cm, so that sums and differences of
/// numbers of the file print as one computes them by hand (1.2 - 0.0375 is 116.25 cm).
[[nodiscard]] std::string centimetreText(double metre);

/// Whether a text is a name of 1 to `most` letters, digits and `signs`, beginning with a letter or
/// digit.
[[nodiscard]] bool isBareName(std::string_view text, std::size_t most,
                              std::string_view signs = "_-");

/// A text as a TOML string, in quotes.
[[nodiscard]] std::string tomlString(std::string_view text);

}  // namespace lab::keys
