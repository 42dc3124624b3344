/// Numbers as text for reports, the page and the terminal: in centimetres, and with no more digits
/// than the error justifies.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lab {

/// The display unit of an SI unit.
struct DisplayUnit {
  std::string text;   ///< "cm²/s", empty for a pure number
  std::string key;    ///< in keys of summary.json: "cm2_s", empty for a pure number
  double factor = 1;  ///< displayed value = factor * SI value
};

/// @param si_unit as the analysis and programs write it: "m^2/s", "1/(m s)". An unknown unit is
///   displayed as it is.
[[nodiscard]] DisplayUnit displayUnit(const std::string& si_unit);

/// "5 cm/s", "0.3333 1/s", "2": a number in its display unit.
/// @param digits significant ones, at most
[[nodiscard]] std::string quantityText(double value, const std::string& si_unit, int digits);

/// "0.748": rounded to two significant figures of `error`, to four significant figures if there is
/// no error; "–" if the value is not finite.
[[nodiscard]] std::string valueText(double value, double error);

/// Four significant figures without trailing zeros; "–" if the value is not finite.
[[nodiscard]] std::string shortText(double value);

/// "3.2 s", "12 min 5 s", "1 h 0 min".
[[nodiscard]] std::string durationText(double seconds);

/// "1 robot", "2 robots".
[[nodiscard]] std::string countText(std::int64_t count, std::string_view noun);

/// "1 234 567", with narrow no-break spaces.
[[nodiscard]] std::string groupedText(std::int64_t count);

/// "2026-01-31 12:00:05 UTC"
[[nodiscard]] std::string utcText(std::int64_t utime);

/// "D_r" as "<i>D</i><sub>r</sub>", "gamma" as "<i>γ</i>".
[[nodiscard]] std::string symbolHtml(const std::string& name);

/// Escapes <, >, &, " and ' and removes control characters other than line ends.
[[nodiscard]] std::string escapeHtml(std::string_view text);

/// A text as part of a file name: keeps letters, digits, '-' and '_', turns spaces into '_';
/// "program" if nothing is left.
[[nodiscard]] std::string sanitizedFileName(std::string_view text);

/// Whether a spreadsheet takes a text in a CSV file for a formula, which may send data elsewhere.
/// Such a text gets a ' before it.
[[nodiscard]] bool isSpreadsheetFormula(std::string_view text);

}  // namespace lab
