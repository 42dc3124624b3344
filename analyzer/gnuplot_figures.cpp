#include "analyzer/gnuplot_figures.hpp"

#include <utility>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "analyzer/report/html/html_style.hpp"

namespace lab::report {

std::vector<DrawnFigure> drawFigureScripts(const std::vector<ScriptedFigure>& figures,
                                           const std::filesystem::path& scratch) {
  std::vector<FigureScript> scripts;
  for (const ScriptedFigure& figure : figures) {
    FigureScript script;
    script.figure.name = figure.name;
    script.figure.title = figure.title;
    script.figure.caption = figure.caption;
    script.script = figure.script;
    scripts.push_back(std::move(script));
  }
  std::vector<DrawnFigure> drawn;
  for (Figure& figure : drawScripts(std::move(scripts), scratch)) {
    drawn.push_back({std::move(figure.name), std::move(figure.title), std::move(figure.caption),
                     std::move(figure.svg), std::move(figure.pdf)});
  }
  return drawn;
}

std::string figurePreamble(const std::string& name, int width, int height, bool wide) {
  return style::preamble(name, width, height, wide ? style::kPage_cm : style::kColumn_cm);
}

std::string quotedForGnuplot(std::string_view text) { return gnuplotText(text); }

std::string svgElement(const std::string& svg, const std::string& prefix) {
  return inlineSvg(svg, prefix);
}

std::string_view pageStyle() { return html::kStyle; }

}  // namespace lab::report
