#include "analyzer/report/figures/figure_scripts.hpp"

#include <array>

namespace lab::report::style {

std::string_view programColour(int key) {
  constexpr std::array<std::string_view, 7> kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                     "#E69F00", "#56B4E9", "#000000"};
  return key < 0 ? kGrey : kColours[static_cast<std::size_t>(key) % kColours.size()];
}

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
