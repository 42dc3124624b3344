/// Values as they stand in a file: numbers in the unit that the key's name says, as short as they
/// can be, and texts in quotes.
#pragma once

#include <string>
#include <string_view>

namespace lab::keys {

/// A unit of the file: SI = file * multiply / divide.
struct FileUnit {
  std::string_view suffix;  ///< how a key with this unit ends, "_cm_s"
  std::string_view text;    ///< for people, "cm/s"
  double multiply = 1;
  double divide = 1;
};

/// The unit that a key's name says ("width_cm": centimetres); no conversion for a bare name.
[[nodiscard]] const FileUnit& unitOf(std::string_view key);

[[nodiscard]] double toSi(double file_value, const FileUnit& unit);

/// The nearest number with so many significant digits.
[[nodiscard]] double roundedToDigits(double value, int digits);

/// The shortest decimal that reads back as the same double, without an exponent from 1e-5 to 1e15.
[[nodiscard]] std::string numberText(double value);

/// The shortest number that toSi() turns into exactly `si`, as text. A double that no number of the
/// file can reach (none that came from a file is one) gives the nearest that can be.
[[nodiscard]] std::string fileText(double si, const FileUnit& unit);

/// A length in centimetres, "116.25". Rounded to the nanometre, so that sums and differences of
/// numbers of the file print as one computes them by hand (1.2 - 0.0375 is 116.25 cm).
[[nodiscard]] std::string centimetreText(double metre);

/// A TOML string.
[[nodiscard]] std::string tomlString(std::string_view text);

}  // namespace lab::keys
