/// Numbers and texts for people: centimetres where the messages have metres, and no more digits
/// than the error allows.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lab {

/// A unit of the analysis as people read it.
struct DisplayUnit {
  std::string text;   ///< "cm²/s", empty for a pure number
  std::string key;    ///< in keys of summary.json: "cm2_s", empty for a pure number
  double factor = 1;  ///< people's value = factor * SI value
};

/// Of an SI unit as the analysis writes it: "m^2/s".
[[nodiscard]] DisplayUnit displayUnit(const std::string& si_unit);

/// "0.748": as many digits as show two figures of `error`; four figures where there is no error;
/// "–" for a number that is none.
[[nodiscard]] std::string valueText(double value, double error);

/// Four significant figures, without trailing zeros; "–" for a number that is none.
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

/// Text with <, >, &, " and ' escaped, control characters other than line ends left out.
[[nodiscard]] std::string escapeHtml(std::string_view text);

/// Letters, digits, '-' and '_' of the text, for names of files; "program" where nothing is left.
[[nodiscard]] std::string sanitizedFileName(std::string_view text);

}  // namespace lab
