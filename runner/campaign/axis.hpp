/// The swept keys of a campaign. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::runner::campaign {

/// An interval from which values are drawn.
struct DrawnRange {
  double low = 0;
  double high = 0;
  bool logarithmic = false;  ///< uniform in the logarithm
  double step = 0;           ///< rounded to multiples of it; 0: not rounded
};

/// One swept key with its values.
struct Axis {
  std::string key;                  ///< as for --set: "programs.NAME.eta_rad_s"
  std::vector<std::string> values;  ///< as in a file; empty: they are drawn from the range
  std::optional<DrawnRange> range;

  /// Whether all values are numbers.
  [[nodiscard]] bool isNumeric() const;

  /// The last part of the key, without the unit: "eta".
  [[nodiscard]] std::string symbol() const;

  /// The unit of the key as text: "rad/s"; empty: none.
  [[nodiscard]] std::string unit() const;
};

/// Parses what follows --over:
///
///     key=1,2,3            these values; they may be texts, or lists as [1, 2]
///     key=0.1:0.9:9        nine values from 0.1 to 0.9, equally spaced
///     key=0.1:10:5:log     five values, equally spaced in the logarithm
///     key=1:40:4:whole     rounded to integers; round=0.01 rounds to multiples of 0.01
///     key=0.1:0.9          values drawn between 0.1 and 0.9 (with --random); also :log, :whole and
///                          :round=...
///
/// @param option of the command line, for messages
/// @throws UserError that quotes option and text
[[nodiscard]] Axis parseAxis(std::string_view text, std::string_view option = "--over");

/// Parses several axes.
/// @throws UserError if a key is given twice, or cannot be swept
[[nodiscard]] std::vector<Axis> parseAxes(const std::vector<std::string>& texts,
                                          std::string_view option = "--over");

/// The text of a value of a range, rounded as the range says.
[[nodiscard]] std::string rangeValue(const DrawnRange& range, double value);

/// The value as a number, if it is one.
[[nodiscard]] std::optional<double> numberIn(std::string_view text);

}  // namespace lab::runner::campaign
