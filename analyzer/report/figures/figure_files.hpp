/// Draws figures as files with one gnuplot process, and writes their data.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/report/figures/figure_scripts.hpp"

namespace lab::report {

/// Draws every script that is not empty as SVG, and as PDF in the width of a journal column or page
/// with 8 pt text. The same scripts give the same bytes.
/// @param scratch an existing folder for temporary files, which are removed.
/// @throws ReportError if gnuplot is missing or rejects a script.
[[nodiscard]] std::vector<Figure> drawScripts(std::vector<FigureScript> scripts,
                                              const std::filesystem::path& scratch);

/// A CSV table. The header names the units.
class CsvText {
 public:
  explicit CsvText(std::string_view header) {
    text_.append(header);
    text_.push_back('\n');
  }

  /// Adds a row. Numbers that are not finite are empty fields, as pandas and R expect.
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
