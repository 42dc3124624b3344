#include "tracker_svc/calibration/board.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <iterator>
#include <stdexcept>

namespace lab::calibration {
namespace {

constexpr int kFewest = 4;
constexpr int kMost = 30;
constexpr double kMilli = 1e3;

}  // namespace

BoardSpec boardFrom(const std::string& text) {
  BoardSpec board;
  double spacing_cm = 0;
  int used = 0;
  const int read =
      std::sscanf(text.c_str(), "%dx%d,%lf%n", &board.columns, &board.rows, &spacing_cm, &used);
  const auto fits = [](int count) { return count >= kFewest && count <= kMost; };
  if (read != 3 || used != static_cast<int>(text.size()) || !fits(board.columns) ||
      !fits(board.rows) || !(spacing_cm >= 0.5 && spacing_cm <= 50)) {
    throw std::invalid_argument(
        fmt::format("found \"{}\", expected columns x rows, spacing in cm, as 9x6,3; {} to {} "
                    "columns and rows, "
                    "0.5 to 50 cm",
                    text, kFewest, kMost));
  }
  board.spacing = spacing_cm / 100;
  return board;
}

std::string boardSvg(const BoardSpec& board) {
  const double step = kMilli * board.spacing;
  const double width = step * (board.columns + 1);
  const double height = step * (board.rows + 1);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}mm\" height=\"{1:g}mm\" "
      "viewBox=\"0 0 {0:g} {1:g}\">\n<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"white\"/>\n",
      width, height);
  for (int row = 1; row <= board.rows; ++row) {
    for (int column = 1; column <= board.columns; ++column) {
      fmt::format_to(std::back_inserter(svg), "<circle cx=\"{:g}\" cy=\"{:g}\" r=\"{:g}\"/>\n",
                     step * column, step * row, kMilli * board.discRadius());
    }
  }
  return svg + "</svg>\n";
}

}  // namespace lab::calibration
