#include "analyzer/report/figures/figure_scripts.hpp"

namespace lab::report::style {

std::string preamble(const std::string& name, int width, int height, double print_cm) {
  return fmt::format(
      "reset\n"
      "set encoding utf8\n"
      "eval open_figure('{}', {}, {}, {:.4g})\n"
      "set border lc rgb '#404040'\n"
      "set tics nomirror tc rgb '#202020'\n"
      "set key noenhanced samplen 2.2\n",
      name, width, height, print_cm);
}

TimeAxis timeAxis(double duration) {
  if (duration <= 300) return {1, "s"};
  if (duration <= 4 * 3600) return {60, "min"};
  return {3600, "h"};
}

}  // namespace lab::report::style
