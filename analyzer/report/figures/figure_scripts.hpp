/// The gnuplot script of each figure.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "analyzer/report/figures/figures.hpp"
#include "analyzer/report/record/run_record.hpp"
#include "analyzer/report/summary/findings.hpp"

namespace lab::report {

/// A figure with its gnuplot script.
struct FigureScript {
  Figure figure;       ///< svg and pdf are empty
  std::string script;  ///< empty if the figure has a sentence
};

/// A figure without a script so far.
[[nodiscard]] inline FigureScript beginFigure(const char* name, const char* title) {
  FigureScript script;
  script.figure.name = name;
  script.figure.title = title;
  return script;
}

[[nodiscard]] FigureScript trajectoryByTime(const RunRecord& record);
[[nodiscard]] FigureScript trajectoryByProgram(const RunRecord& record);
[[nodiscard]] FigureScript lightAndPrograms(const RunRecord& record);
[[nodiscard]] FigureScript speedTraces(const RunRecord& record);
/// The MSD of all programs in one picture, each with its exact law.
[[nodiscard]] FigureScript msdOverview(const std::vector<Finding>& findings);
[[nodiscard]] FigureScript msdFigure(const Finding& finding);
[[nodiscard]] FigureScript angularMsdFigure(const Finding& finding);
/// The distribution of run times, with a logarithmic density axis. The finding must have runs.
[[nodiscard]] FigureScript runTimesFigure(const Finding& finding);
/// The histogram of tumble angles. The finding must have runs.
[[nodiscard]] FigureScript turnsFigure(const Finding& finding);

namespace style {

/// Okabe and Ito's colours, which are distinguishable with colour blindness. Black is reserved for
/// data.
inline constexpr std::string_view kBlue = "#0072B2";
inline constexpr std::string_view kVermillion = "#D55E00";
inline constexpr std::string_view kPaleGrey = "#D8D8D8";

/// Widths in print [cm]: a journal column, and the page.
inline constexpr double kColumn_cm = 8.6;
inline constexpr double kPage_cm = 17.8;

/// Common settings at the beginning of every figure. The rest of the script may use the gnuplot
/// variables `on_paper` (1 in the PDF, where text is larger relative to the width, else 0) and
/// `small_font`.
/// @param width, height in pixels, for text of 16 pixels
[[nodiscard]] std::string preamble(const std::string& name, int width, int height,
                                   double print_cm = kColumn_cm);

/// The unit of a time axis.
struct TimeAxis {
  double scale = 1;  ///< axis = seconds / scale
  std::string unit = "s";
};
[[nodiscard]] TimeAxis timeAxis(double duration);

}  // namespace style

/// A named block of data in a gnuplot script.
class DataBlock {
 public:
  explicit DataBlock(std::string_view name) {
    fmt::format_to(std::back_inserter(text_), "${} << EOD\n", name);
  }
  template <class... Values>
  void row(Values... values) {
    ((fmt::format_to(std::back_inserter(text_), "{:.7g} ", values)), ...);
    text_.push_back('\n');
  }
  void blank() { text_.push_back('\n'); }
  [[nodiscard]] std::string text() const { return fmt::to_string(text_) + "EOD\n"; }

 private:
  fmt::memory_buffer text_;
};

}  // namespace lab::report
