#include "analyzer/report/figures/figure_files.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>

#include "analyzer/report/figures/gnuplot.hpp"
#include "analyzer/report/figures/undated_pdf.hpp"
#include "analyzer/report_error.hpp"
#include "common/files/file_text.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace fs = std::filesystem;
namespace {

// Figures open their file by open_figure(name, width px, height px, width in print cm), so that one
// script serves both formats. Journals want 8 pt text for any width.
constexpr const char* kForScreen =
    "on_paper = 0\nsmall_font = 'Arial,14'\n"
    "open_figure(name, w, h, cm) = sprintf(\"set terminal svg size %d,%d dynamic font 'Arial,16' "
    "background 'white' noenhanced linewidth 1.2; set output '%s.svg'\", w, h, name)\n";
constexpr const char* kForPaper =
    "on_paper = 1\nsmall_font = 'Helvetica,7'\n"
    "open_figure(name, w, h, cm) = sprintf(\"set terminal pdfcairo color noenhanced font "
    "'Helvetica,8' background 'white' linewidth 0.8 pointscale 0.6 dashlength 1 size "
    "%.3fcm,%.3fcm; set output '%s.pdf'\", cm, cm * h / w, name)\n";

/// Reads a file that gnuplot wrote, and removes it.
std::string takeFile(const fs::path& file, const std::string& title) {
  std::string text = readWholeFile(file).value_or("");
  if (text.empty()) {
    constexpr std::uintmax_t kFull = 1'000'000;  // [bytes]
    std::error_code error;
    const fs::space_info space = fs::space(file.parent_path(), error);
    const std::string nothing = "gnuplot drew nothing for " + title;
    if (error || space.available > kFull) throw ReportError(nothing);
    throw ReportError(fmt::format("the disk is full ({} kB left in {}): {}", space.available / 1000,
                                  file.parent_path().string(), nothing));
  }
  fs::remove(file);
  return text;
}

}  // namespace

std::vector<Figure> drawScripts(std::vector<FigureScript> scripts, const fs::path& scratch) {
  std::string all;
  for (const FigureScript& one : scripts) all += one.script;
  if (!all.empty()) {
    runGnuplot(scratch, kForScreen + all + "reset\n" + kForPaper + all + "unset output\n");
  }
  std::vector<Figure> figures;
  for (FigureScript& one : scripts) {
    Figure& figure = one.figure;
    if (!one.script.empty()) {
      figure.svg = tidySvg(takeFile(scratch / (figure.name + ".svg"), figure.title), figure.title);
      figure.pdf = undatedPdf(takeFile(scratch / (figure.name + ".pdf"), figure.title));
    }
    figures.push_back(std::move(figure));
  }
  return figures;
}

void CsvText::cell(double value, bool first) {
  separate(first);
  if (std::isfinite(value)) fmt::format_to(std::back_inserter(text_), "{:.7g}", value);
}

void CsvText::cell(std::string_view word, bool first) {
  separate(first);
  const std::string_view mark = isSpreadsheetFormula(word) ? "'" : "";
  if (word.find_first_of(",\"\r\n") == std::string_view::npos) {
    text_.append(mark);
    text_.append(word);
    return;
  }
  text_.push_back('"');
  text_.append(mark);
  for (const char letter : word) {
    if (letter == '"') text_.push_back('"');
    text_.push_back(letter == '\n' || letter == '\r' ? ' ' : letter);
  }
  text_.push_back('"');
}

}  // namespace lab::report
