#include "analyzer/report/reproduction/reproduction_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "analyzer/report/reproduction/reproduction_paths.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace panels {
namespace {

using analysis::CurvePoint;
using units::kCm;
using units::kNan;

constexpr double kSqCm = 1e4;
constexpr double kLimitZ = 4;

/// Colour and symbol of one series of a panel. Each alone identifies the series.
struct SeriesStyle {
  std::string_view colour;
  int symbol;       ///< gnuplot's, filled
  int open_symbol;  ///< the same, hollow
};

SeriesStyle seriesStyle(std::size_t series, std::size_t of) {
  // Okabe and Ito's colours without the one of the paper's formula.
  constexpr std::array<SeriesStyle, 6> kStyles{{{"#0072B2", 7, 6},
                                                {"#E69F00", 5, 4},
                                                {"#009E73", 9, 8},
                                                {"#CC79A7", 13, 12},
                                                {"#56B4E9", 11, 10},
                                                {"#707070", 15, 14}}};
  return of == 1 ? SeriesStyle{"#000000", 7, 6} : kStyles[series % kStyles.size()];
}

struct Series {
  const SetData* set;
  std::string label;
  std::vector<CurvePoint> points;
  SeriesStyle style;
};

bool drawable(const CurvePoint& point) {
  return point.windows > 0 && std::isfinite(point.value) && point.value > 0 && point.tau > 0;
}

FigureScript begin(const PaperPanel& panel) {
  FigureScript script;
  script.figure.name = "fig" + panel.id;
  script.figure.title = fmt::format("Figure {}. {}", panel.id, panel.title);
  return script;
}

/// The lower part: deviations from the exact law in standard errors.
std::string strip(double largest, const std::string& plots, const std::string& abscissa) {
  const double range = std::clamp(largest * 1.2, 5.0, 14.0);
  return fmt::format(
      "unset logscale y\nset format x '%g'\nset format y '%g'\nset tmargin at screen 0.33\n"
      "set bmargin at screen 0.16\nunset key\nset xlabel '{}'\nset ylabel 'dev. (σ)' offset 0.5\n"
      "set yrange [-{:.4g}:{:.4g}]\nset ytics ({})\n"
      "set object 2 rectangle from graph 0,first -2 to graph 1,first 2 behind fs solid noborder "
      "fc rgb '#E8EFF5'\n"
      "plot {} with lines lw 0.8 dt (4,4) lc rgb '#808080', "
      "-{} with lines lw 0.8 dt (4,4) lc rgb '#808080', 0 with lines lw 1 lc rgb 'black'{}\n",
      abscissa, range, range, range > 8 ? "-8, -4, 0, 4, 8" : "-4, 0, 4", kLimitZ, kLimitZ, plots);
}

std::string inset(double left, double right, double bottom, double top, const std::string& x,
                  const std::string& y) {
  return fmt::format(
      "unset object 2\nunset logscale\nset lmargin at screen {:.4g}\nset rmargin at screen {:.4g}\n"
      "set bmargin at screen {:.4g}\nset tmargin at screen {:.4g}\nset tics font small_font\n"
      "set xlabel '{}' font small_font offset 0,1.1\nset ylabel ''\n"
      "set label 1 '{}' at graph 0.05,0.84 left font small_font\n"
      "set xrange [*:*]\nset yrange [*:*]\nset format '%g'\nset xtics autofreq offset 0,0.3\n"
      "set ytics autofreq offset 0.4\nunset key\n",
      left, right, bottom, top, x, y);
}

/// Adds the inset with D_r or D of its sets and the theory to `drawing`. @return its data.
std::string pointsInset(const PaperPanel& panel, const Reproduction& reproduction,
                        std::string& drawing, CsvText& csv) {
  DataBlock points("points");
  DataBlock origin("origin");
  points.row(kNan, kNan, kNan);
  origin.row(kNan, kNan);
  const bool diffusion = panel.inset == Inset::kDOverTheory;
  double last = 0;
  double first = 1e300;
  for (const std::string& id : panel.points) {
    const auto found = reproduction.find(id);
    if (found == reproduction.end() || found->second.recordings.empty()) continue;
    const SetData& set = found->second;
    const analysis::ProgramLaw& law = set.recordings.front().result.law;
    auto estimate = estimateOf(set, diffusion ? "D" : "D_r");
    if (diffusion && !estimate) estimate = estimateOf(set, "D_t");
    if (!estimate || !std::isfinite(estimate->value)) continue;
    const double factor = diffusion ? kSqCm : 1;
    const double x = diffusion ? law->translationalDiffusivity() * kSqCm
                     : panel.inset == Inset::kDrOverEpsilon ? law->parameter("epsilon")
                                                            : law->parameter("eta");
    const double line = lineThroughOrigin(set, !diffusion) * factor;
    points.row(x, estimate->value * factor, estimate->sigma * factor);
    origin.row(x, line);
    last = std::max(last, x);
    first = std::min(first, x);
    csv.row(diffusion ? "D_cm2_s_over_epsilon_V2_24" : "D_r_rad2_s", id, x,
            estimate->value * factor, estimate->sigma * factor, "", estimate->theory * factor, line,
            "", "");
  }
  if (last == 0) return {};
  const char* x = diffusion                              ? "ε V²/24 (cm²/s)"
                  : panel.inset == Inset::kDrOverEpsilon ? "ε (s)"
                                                         : "η (rad/s)";
  drawing += inset(0.70, 0.955, 0.49, 0.645, x, diffusion ? "D (cm²/s)" : "D_r (1/s)");
  const std::string theory = diffusion                              ? "x"
                             : panel.inset == Inset::kDrOverEpsilon ? "x*9/6."
                                                                    : "0.25*x**2/6.";
  const bool logarithmic = panel.inset == Inset::kDrOverEta || diffusion;
  drawing += fmt::format(
      "{}set xrange [{:.4g}:{:.4g}]\nset yrange [*:*]\n"
      "plot {} with lines lw 1.2 lc rgb 'black', "
      "$origin using 1:2 with points pt 4 ps 0.6 lw 1 lc rgb '{}', "
      "$points using 1:($2-$3):(0):(2*$3) with vectors nohead lw 1 lc rgb '{}', "
      "$points using 1:2 with points pt 7 ps 0.45 lc rgb '{}'\n",
      logarithmic ? "set logscale xy\n" : "", logarithmic ? first / 1.4 : 0.0,
      last * (logarithmic ? 1.4 : 1.1), theory, style::kVermillion, style::kBlue, style::kBlue);
  if (panel.inset == Inset::kDrOverEta) {
    drawing.replace(drawing.rfind("set logscale xy\n"), 16,
                    "set logscale xy\nset xtics (1,2,3,6)\nset ytics (0.1,1)\n");
  } else if (diffusion) {
    drawing.replace(drawing.rfind("set logscale xy\n"), 16,
                    "set logscale xy\nset xtics (0.1,1)\nset ytics (0.1,1)\n");
  } else {
    drawing.replace(drawing.rfind("set xrange ["), 12,
                    "set xtics 0.4\nset ytics 0.5\nset xrange [");
  }
  return points.text() + origin.text();
}

FigureScript curves(const PaperPanel& panel, const Reproduction& reproduction) {
  FigureScript script = begin(panel);
  const bool angular = panel.kind == PanelKind::kAngularMsd;
  const double factor = angular ? 1 : kSqCm;
  const std::string unit = angular ? "rad2" : "cm2";
  std::vector<Series> all;
  for (const std::string& id : panel.curves) {
    const auto found = reproduction.find(id);
    if (found == reproduction.end() || found->second.recordings.empty()) continue;
    const std::vector<CurvePoint> points = curveOf(found->second, angular);
    if (std::count_if(points.begin(), points.end(), drawable) < 2) continue;
    all.push_back({&found->second, curveLabel(panel, found->second.set), points,
                   seriesStyle(all.size(), panel.curves.size())});
  }
  if (all.empty()) {
    script.figure.sentence = "Too little motion for a curve.";
    return script;
  }
  CsvText csv(
      fmt::format("what,set,lag_s,value_{0},standard_error_{0},noise_{0},exact_{0},"
                  "paper_{0},z,judged",
                  unit));
  std::string data;
  std::string upper;
  std::string laws;
  std::string papers;
  std::string lower;
  double first = 1e300;
  double last = 0;
  double least = 1e300;
  double most = 0;
  double largest = 0;
  for (std::size_t s = 0; s < all.size(); ++s) {
    const Series& one = all[s];
    DataBlock points(fmt::format("points{}", s));
    DataBlock open(fmt::format("open{}", s));
    DataBlock law(fmt::format("law{}", s));
    DataBlock paper(fmt::format("paper{}", s));
    DataBlock off(fmt::format("off{}", s));
    for (DataBlock* block : {&points, &open, &law, &paper, &off})
      block->row(kNan, kNan, kNan, kNan);
    for (const CurvePoint& p : one.points) {
      if (!drawable(p)) continue;
      constexpr double kLeastShare = 0.02;  // error bars end above 0, for the logarithmic axis
      const double sigma = std::isfinite(p.sigma) ? p.sigma : 0;
      const double low = std::max(p.value - sigma, kLeastShare * p.value);
      (p.judged ? points : open)
          .row(p.tau, p.value * factor, low * factor, (p.value + sigma) * factor);
      law.row(p.tau, (p.exact + p.noise) * factor);
      if (std::isfinite(p.paper)) paper.row(p.tau, p.paper * factor);
      if (std::isfinite(p.z) && p.judged) {
        off.row(p.tau, p.z);
        largest = std::max(largest, std::abs(p.z));
      }
      first = std::min(first, p.tau);
      last = std::max(last, p.tau);
      least = std::min(least, p.value * factor);
      most = std::max(most, p.value * factor);
      csv.row("curve", one.set->set.id, p.tau, p.value * factor, p.sigma * factor, p.noise * factor,
              p.exact * factor, p.paper * factor, p.z, p.judged);
    }
    data += points.text() + open.text() + law.text() + paper.text() + off.text();
    upper += fmt::format(
        ", $open{0} using 1:2 with points pt {2} ps 0.45 lw 0.8 lc rgb '{3}' notitle, "
        "$points{0} using 1:3:(0):($4-$3) with vectors nohead lw 1 lc rgb '{3}' notitle, "
        "$points{0} using 1:2 with points pt {1} ps 0.45 lc rgb '{3}' title {4}",
        s, one.style.symbol, one.style.open_symbol, one.style.colour, gnuplotText(one.label));
    papers += fmt::format("{}$paper{} using 1:2 with lines lw 1.6 dt (8,5) lc rgb '{}' {}",
                          papers.empty() ? "" : ", ", s, style::kVermillion,
                          s == 0 ? "title " + gnuplotText("paper: " + panel.formula) : "notitle");
    laws += fmt::format(", $law{} using 1:2 with lines lw 1.3 lc rgb '{}' {}", s,
                        all.size() == 1 ? style::kBlue : std::string_view("#000000"),
                        s == 0 ? "title 'exact law'" : "notitle");
    lower += fmt::format(", $off{} using 1:2 with points pt {} ps 0.45 lc rgb '{}'", s,
                         one.style.symbol, one.style.colour);
  }
  std::string drawing = fmt::format(
      "set multiplot\nset lmargin at screen (on_paper ? 0.24 : 0.19)\nset rmargin at screen 0.965\n"
      "set logscale xy\nset format y '%g'\nset format x ''\nset tmargin at screen 0.97\n"
      "set bmargin at screen 0.37\nset xrange [{:.6g}:{:.6g}]\nset yrange [{:.4g}:{:.4g}]\n"
      "set ylabel '{}' offset 0.5\nset key top left Left reverse samplen 1.6 spacing 0.95\n"
      "plot {}{}{}\n",
      first / 1.4, last * 1.4, least / (panel.inset == Inset::kNone ? 1.6 : 5),
      most * (all.size() == 1               ? 2.5
              : panel.inset == Inset::kNone ? 6
                                            : 200),
      angular ? "angular MSD (rad²)" : "MSD (cm²)", papers, laws, upper);
  drawing += strip(largest, lower, "lag (s)");
  data += pointsInset(panel, reproduction, drawing, csv);
  script.script =
      data + style::preamble(script.figure.name, kWidth, kHeight) + drawing + "unset multiplot\n";
  script.figure.csv = csv.text();
  script.figure.caption = fmt::format(
      "Bars: one standard error. Hollow: not judged. Below, deviations from the exact law.{}",
      panel.inset == Inset::kNone ? ""
      : panel.inset == Inset::kDOverTheory
          ? " Inset: D of the exact law’s fit (dots), of the paper’s line through the origin "
            "(squares), and D = ε V²/24."
          : " Inset: D_r of the exact law’s fit (dots), of the paper’s line through the origin "
            "(squares), and D_r = ε η²/6.");
  return script;
}

FigureScript persistence(const PaperPanel& panel, const Reproduction& reproduction) {
  FigureScript script = begin(panel);
  CsvText csv("what,set,x,value,standard_error,exact,paper");
  DataBlock integral("integral");
  DataBlock fitted("fitted");
  DataBlock off("off");
  DataBlock off_paper("offpaper");
  DataBlock law("law");
  for (DataBlock* block : {&integral, &fitted, &off, &off_paper, &law})
    block->row(kNan, kNan, kNan);
  std::string correlations;
  std::string data;
  double largest = 0;
  std::size_t number = 0;
  const analysis::ProgramLaw* any = nullptr;
  for (const std::string& id : panel.curves) {
    const auto found = reproduction.find(id);
    if (found == reproduction.end() || found->second.recordings.empty()) continue;
    const RecordingData& recording = found->second.recordings.front();
    const analysis::ProgramLaw& program = recording.result.law;
    const auto length = estimateOf(found->second, "L_s");
    if (!length || !std::isfinite(length->value)) continue;
    any = &program;
    const double eta = program->parameter("eta");
    const double paper = program->meanSpeed() / program->rotationalDiffusivity() * kCm;
    integral.row(eta, length->value * kCm, length->sigma * kCm);
    const double z = (length->value - length->theory) / length->sigma;
    off.row(eta, z);
    largest = std::max(largest, std::abs(z));
    off_paper.row(eta, (paper / kCm - length->theory) / length->sigma);
    csv.row("L_s_integral_cm_at_eta_rad_s", id, eta, length->value * kCm, length->sigma * kCm,
            length->theory * kCm, paper);
    if (recording.correlation.empty()) continue;
    fitted.row(eta, recording.fitted_length, recording.fitted_length_sigma);
    csv.row("L_s_exponential_fit_cm_at_eta_rad_s", id, eta, recording.fitted_length,
            recording.fitted_length_sigma, "", paper);
    DataBlock block(fmt::format("c{}", number));
    const analysis::ExactLaw exact(program);
    const double square = program->meanSpeed() * program->meanSpeed();
    for (const CorrelationPoint& p : recording.correlation) {
      block.row(p.length, p.value);
      csv.row("C_of_l_at_l_cm", id, p.length, p.value, p.sigma,
              exact.velocityCorrelation(p.length / kCm / program->meanSpeed()) / square,
              std::exp(-p.length / paper));
    }
    data += block.text();
    const SeriesStyle own = seriesStyle(number, panel.curves.size());
    correlations += fmt::format("{}$c{} using 1:2 with linespoints pt {} ps 0.3 lw 0.8 lc rgb '{}'",
                                number == 0 ? "" : ", ", number, own.symbol, own.colour);
    ++number;
  }
  if (any == nullptr) {
    script.figure.sentence = "Too short a recording for a persistence length.";
    return script;
  }
  for (int i = 0; i <= 60; ++i) {
    const double eta = 0.8 * std::pow(8.0, i / 60.0);
    const analysis::ProgramLaw program = any->with("eta", eta);
    law.row(eta, analysis::ExactLaw(program).persistenceLength() * kCm,
            program->meanSpeed() / program->rotationalDiffusivity() * kCm);
  }
  for (const DataBlock* block : {&integral, &fitted, &off, &off_paper, &law}) data += block->text();
  std::string drawing = fmt::format(
      "set multiplot\nset lmargin at screen (on_paper ? 0.24 : 0.19)\nset rmargin at screen 0.965\n"
      "set logscale xy\nset format y '%g'\nset format x ''\nset tmargin at screen 0.97\n"
      "set bmargin at screen 0.37\nset xrange [0.8:6.8]\nset yrange [0.5:400]\n"
      "set xtics (1,2,3,4,5,6)\nset ylabel 'L_s (cm)' offset 0.5\n"
      "set key bottom left Left reverse samplen 1.6 spacing 0.95\n"
      "plot $law using 1:3 with lines lw 1.6 dt (8,5) lc rgb '{0}' title 'paper: v / D_r', "
      "$law using 1:2 with lines lw 1.3 lc rgb 'black' title 'exact integral of C(l)', "
      "$fitted using 1:($2-$3):(0):(2*$3) with vectors nohead lw 1 lc rgb '{1}' notitle, "
      "$fitted using 1:2 with points pt 4 ps 0.9 lw 1.4 lc rgb '{1}' title 'exp. fit of C(l)', "
      "$integral using 1:($2-$3):(0):(2*$3) with vectors nohead lw 1 lc rgb '{2}' notitle, "
      "$integral using 1:2 with points pt 7 ps 0.5 lc rgb '{2}' title 'integral of C(l)'\n",
      style::kVermillion, "#E69F00", style::kBlue);
  drawing += strip(std::max(largest, 5.0),
                   fmt::format(", $offpaper using 1:2 with lines lw 1.6 dt (8,5) lc rgb '{}', "
                               "$off using 1:2 with points pt 7 ps 0.6 lc rgb '{}'",
                               style::kVermillion, style::kBlue),
                   "η (rad/s)");
  if (!correlations.empty()) {
    drawing += inset(0.60, 0.945, 0.73, 0.945, "l (cm)", "") +
               "set label 1 'C(l)' at graph 0.8,0.84 left font small_font\n" +
               fmt::format(
                   "set xrange [0:30]\nset yrange [-0.1:1.05]\nset xtics 10\nset ytics 0.5\n"
                   "plot {}\n",
                   correlations);
  }
  script.script =
      data + style::preamble(script.figure.name, kWidth, kHeight) + drawing + "unset multiplot\n";
  script.figure.csv = csv.text();
  script.figure.caption =
      "Dots: the integral of C(l) of the fitted exact law; squares: an exponential fitted to C(l), "
      "as "
      "the paper does. Inset: C(l) = 〈n(0)·n(l)〉 of the heading along the stitched track for η = "
      "1 "
      "(slowest) to 6 rad/s.";
  return script;
}

}  // namespace
}  // namespace panels

std::vector<FigureScript> panelFigures(const std::vector<PaperPanel>& chosen,
                                       const Reproduction& reproduction) {
  std::vector<FigureScript> scripts;
  for (const PaperPanel& panel : chosen) {
    const auto found = reproduction.find(panel.curves.front());
    const bool is_recorded = found != reproduction.end() && !found->second.recordings.empty();
    switch (panel.kind) {
      case PanelKind::kTrajectory:
      case PanelKind::kRunTumble:
        if (!is_recorded) {
          scripts.push_back(panels::begin(panel));
          scripts.back().figure.sentence = "It was not recorded.";
        } else {
          scripts.push_back(panel.kind == PanelKind::kTrajectory
                                ? panels::trajectory(panel, found->second)
                                : panels::runsAndTumbles(panel, found->second));
        }
        break;
      case PanelKind::kPersistence:
        scripts.push_back(panels::persistence(panel, reproduction));
        break;
      default:
        scripts.push_back(panels::curves(panel, reproduction));
    }
  }
  return scripts;
}

}  // namespace lab::report
