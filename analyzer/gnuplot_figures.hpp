/// Figures and pages in the style of the report, for others than the report: the pages of
/// campaigns.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lab::report {

/// A figure with its gnuplot script, which begins with figurePreamble().
struct ScriptedFigure {
  std::string name;  ///< of its files, without extension
  std::string title;
  std::string caption;  ///< plain text
  std::string script;
};

/// The same as files.
struct DrawnFigure {
  std::string name;
  std::string title;
  std::string caption;
  std::string svg;  ///< the complete file
  std::string pdf;  ///< the complete file, in the width of a journal
};

/// Draws all figures with one gnuplot process. The same scripts give the same bytes.
/// @param scratch an existing folder for temporary files, which are removed
/// @throws ReportError if gnuplot is missing or rejects a script
[[nodiscard]] std::vector<DrawnFigure> drawFigureScripts(const std::vector<ScriptedFigure>& figures,
                                                         const std::filesystem::path& scratch);

/// The settings at the begin of a figure.
/// @param width, height in pixels, for text of 16 pixels
/// @param wide in print, the width of the page instead of a column
[[nodiscard]] std::string figurePreamble(const std::string& name, int width, int height,
                                         bool wide = false);

/// A text as a quoted gnuplot string without markup.
[[nodiscard]] std::string quotedForGnuplot(std::string_view text);

/// The SVG as an element of an HTML page. @param prefix of its ids
[[nodiscard]] std::string svgElement(const std::string& svg, const std::string& prefix);

/// The style sheet of the report's page.
[[nodiscard]] std::string_view pageStyle();

}  // namespace lab::report
