/// Runs gnuplot as a child process.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lab::report {

/// Runs a script in `folder`. User settings of gnuplot and the locale are ignored, so the same
/// script gives the same bytes.
/// @throws ReportError if gnuplot is missing or rejects the script.
void runGnuplot(const std::filesystem::path& folder, const std::string& script);

/// The text as a quoted gnuplot string on one line, without characters that SVG or gnuplot
/// interpret as markup.
[[nodiscard]] std::string gnuplotText(std::string_view text);

/// The SVG of gnuplot with a readable title and common fonts, and without the names of data blocks,
/// which browsers show as tooltips.
[[nodiscard]] std::string tidySvg(const std::string& svg, const std::string& title);

/// The SVG as an element of an HTML page: without XML header, and with `prefix` before its ids, so
/// that a page can contain several figures.
[[nodiscard]] std::string inlineSvg(const std::string& svg, const std::string& prefix);

}  // namespace lab::report
