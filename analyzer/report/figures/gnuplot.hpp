/// gnuplot as a child process.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lab::report {

/// Runs a script in `folder`, where it and its output stay. Neither the user's gnuplot settings nor
/// the locale reach it, so that the same script gives the same bytes.
/// @throws ReportError when gnuplot is missing or refuses the script.
void runGnuplot(const std::filesystem::path& folder, const std::string& script);

/// The text as a gnuplot string that is printed as it stands: quoted, on one line, without what
/// SVG or gnuplot would take for markup.
[[nodiscard]] std::string gnuplotText(std::string_view text);

/// What gnuplot wrote with a title for people, fonts that every machine has, and without the names
/// of its data, which browsers would show as tips.
[[nodiscard]] std::string tidySvg(const std::string& svg, const std::string& title);

/// A PDF without the time when it was made, so that the same figure is the same file.
[[nodiscard]] std::string undatedPdf(std::string pdf);

/// A tidy SVG file as an element of an HTML page: without its XML head, and with ids that begin
/// with `prefix`, so that several figures can stand in one page.
[[nodiscard]] std::string inlineSvg(const std::string& svg, const std::string& prefix);

}  // namespace lab::report
