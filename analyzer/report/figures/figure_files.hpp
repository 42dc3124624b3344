/// Figures as files: drawn by one gnuplot for the screen and for paper, with their data beside
/// them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/report/figures/figure_scripts.hpp"

namespace lab::report {

/// Draws every script that is not empty, twice: as SVG, and as PDF of the width of a journal's
/// column or page with text of 8 pt. The same scripts give the same bytes.
/// @param scratch an existing folder for gnuplot's files, which are gone afterwards.
/// @throws ReportError when gnuplot is missing or refuses a script.
[[nodiscard]] std::vector<Figure> drawScripts(std::vector<FigureScript> scripts,
                                              const std::filesystem::path& scratch);

/// Rows of numbers and words under a header that names the units.
class CsvText {
 public:
  explicit CsvText(std::string_view header) {
    text_.append(header);
    text_.push_back('\n');
  }

  /// A number that is none stays empty, as pandas and R expect it.
  template <class... Values>
  void row(const Values&... values) {
    bool first = true;
    ((cell(values, first), first = false), ...);
    text_.push_back('\n');
  }

  [[nodiscard]] std::string text() const { return fmt::to_string(text_); }

 private:
  void separate(bool first) {
    if (!first) text_.push_back(',');
  }
  void cell(double value, bool first);
  void cell(std::string_view word, bool first);
  void cell(const char* word, bool first) { cell(std::string_view(word), first); }
  void cell(const std::string& word, bool first) { cell(std::string_view(word), first); }
  void cell(bool value, bool first) { cell(std::string_view(value ? "1" : "0"), first); }
  void cell(int value, bool first) { cell(static_cast<double>(value), first); }

  fmt::memory_buffer text_;
};

}  // namespace lab::report
