#include "runner/calibrate/board_finder.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <queue>
#include <vector>

#include "light/photometry/camera_response.hpp"
#include "tracker_svc/circle_fit.hpp"

namespace lab::runner {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int kAround = 40;      // [px] half width of the window for the local mean
constexpr double kDark = 0.6;    // a pixel below this part of the local mean is dark
constexpr int kLeastArea = 30;   // [px]
constexpr int kMostArea = 4000;  // [px]
constexpr double kRound = 0.12;  // largest relative difference between area and ellipse
constexpr double kMostAspect = 4;
constexpr double kNear = 0.3;  // search radius, relative to the distance of the neighbour
constexpr double kLeastCornerSigma = 0.003;  // [px]

struct Disc {
  Vector2d at;
  double sigma = 0;
};

/// 1 for each pixel that is much darker than its surroundings.
std::vector<std::uint8_t> darkPixels(const optics::GreyView& picture) {
  const auto width = static_cast<std::size_t>(picture.width);
  std::vector<std::uint32_t> sums((width + 1) * (static_cast<std::size_t>(picture.height) + 1), 0);
  const auto sum = [&](int x, int y) -> std::uint32_t& {
    return sums[static_cast<std::size_t>(y) * (width + 1) + static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < picture.height; ++y) {
    std::uint32_t row = 0;
    for (int x = 0; x < picture.width; ++x) {
      row += picture.row(y)[x];
      sum(x + 1, y + 1) = sum(x + 1, y) + row;
    }
  }
  std::vector<std::uint8_t> dark(width * static_cast<std::size_t>(picture.height), 0);
  for (int y = 0; y < picture.height; ++y) {
    const int y0 = std::max(0, y - kAround);
    const int y1 = std::min(picture.height, y + kAround + 1);
    for (int x = 0; x < picture.width; ++x) {
      const int x0 = std::max(0, x - kAround);
      const int x1 = std::min(picture.width, x + kAround + 1);
      const std::uint32_t total = sum(x1, y1) - sum(x0, y1) - sum(x1, y0) + sum(x0, y0);
      const double mean = total / (static_cast<double>(x1 - x0) * (y1 - y0));
      dark[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] =
          picture.row(y)[x] < kDark * mean ? 1 : 0;
    }
  }
  return dark;
}

/// Sums over the pixels of a blob.
struct Blob {
  double count = 0;
  Vector2d sum = Vector2d::Zero();
  Matrix2d squares = Matrix2d::Zero();
  bool cut = false;  // touches the edge of the picture
};

/// The connected blob at (x, y), by flood fill; its pixels are cleared in `dark`.
Blob takeBlob(std::vector<std::uint8_t>& dark, int width, int height, int x, int y) {
  Blob blob;
  const auto at = [&](int i, int j) -> std::uint8_t& {
    return dark[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(i)];
  };
  std::vector<std::pair<int, int>> open = {{x, y}};
  at(x, y) = 0;
  const Vector2d origin(x, y);
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    const Vector2d off = Vector2d(i, j) - origin;
    blob.count += 1;
    blob.sum += off;
    blob.squares += off * off.transpose();
    blob.cut = blob.cut || i == 0 || j == 0 || i == width - 1 || j == height - 1;
    for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int ni = i + di;
      const int nj = j + dj;
      if (ni < 0 || nj < 0 || ni >= width || nj >= height || at(ni, nj) == 0) continue;
      at(ni, nj) = 0;
      open.emplace_back(ni, nj);
    }
  }
  blob.squares =
      blob.squares / blob.count - blob.sum * blob.sum.transpose() / (blob.count * blob.count);
  blob.sum = blob.sum / blob.count + origin;
  return blob;
}

std::optional<Disc> discFrom(const optics::GreyView& picture, const Blob& blob) {
  if (blob.cut || blob.count < kLeastArea || blob.count > kMostArea) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Matrix2d> axes(blob.squares);
  const Vector2d variances = axes.eigenvalues();
  if (!(variances[0] > 0) || variances[1] > kMostAspect * kMostAspect * variances[0]) {
    return std::nullopt;
  }
  // The variances of a filled ellipse are a quarter of its squared half axes.
  const double area = 4 * std::numbers::pi * std::sqrt(variances[0] * variances[1]);
  if (std::abs(blob.count / area - 1) > kRound) return std::nullopt;
  const Matrix2d m = (4 * blob.squares).eval();
  const Eigen::SelfAdjointEigenSolver<Matrix2d> outline(m);
  const Matrix2d to_unit = outline.operatorInverseSqrt();
  detector::DiscShape shape{{static_cast<float>(to_unit(0, 0)), static_cast<float>(to_unit(0, 1)),
                             static_cast<float>(to_unit(1, 0)), static_cast<float>(to_unit(1, 1))}};
  detector::CircleFit fit = fitCircle(picture, {blob.sum[0], blob.sum[1]}, shape, {});
  if (fit.fault == detector::FitFault::kNotRound) {
    // The dark pixels give the shape of the outline, but its size only to a few per cent: fit again
    // with the fitted size.
    for (float& element : shape.m) element /= fit.scale;
    fit = fitCircle(picture, {blob.sum[0], blob.sum[1]}, shape, {});
  }
  if (fit.fault != detector::FitFault::kNone) return std::nullopt;
  const double sigma = std::sqrt((fit.covariance[0] + fit.covariance[2]) / 2);
  return Disc{{fit.x, fit.y}, std::max(kLeastCornerSigma, sigma)};
}

std::vector<Disc> discsIn(const optics::GreyView& picture) {
  std::vector<std::uint8_t> dark = darkPixels(picture);
  std::vector<Disc> discs;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const auto index = static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                         static_cast<std::size_t>(x);
      if (dark[index] == 0) continue;
      const Blob blob = takeBlob(dark, picture.width, picture.height, x, y);
      if (const auto disc = discFrom(picture, blob)) discs.push_back(*disc);
    }
  }
  return discs;
}

/// Index of the disc nearest to `place`, or -1 if none is within `reach`.
int nearest(const std::vector<Disc>& discs, const Vector2d& place, double reach) {
  int best = -1;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const double distance = (discs[i].at - place).norm();
    if (distance > reach) continue;
    reach = distance;
    best = static_cast<int>(i);
  }
  return best;
}

/// A disc in the grid, with the vectors to its neighbours in the picture [px].
struct Cell {
  int disc = 0;
  int column = 0;
  int row = 0;
  Vector2d right;
  Vector2d down;
};

/// The grid that contains the disc `first`, grown by breadth-first search.
std::vector<Cell> gridFrom(const std::vector<Disc>& discs, std::size_t first) {
  const Vector2d at = discs[first].at;
  std::vector<Vector2d> offsets;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    if (i != first) offsets.emplace_back(discs[i].at - at);
  }
  std::ranges::sort(offsets, {}, [](const Vector2d& offset) { return offset.norm(); });
  if (offsets.empty()) return {};
  const Vector2d right = offsets[0];
  const auto across = std::ranges::find_if(offsets, [&right](const Vector2d& offset) {
    return std::abs(right.normalized().dot(offset.normalized())) < 0.5;
  });
  if (across == offsets.end()) return {};
  std::vector<bool> taken(discs.size(), false);
  std::vector<Cell> cells;
  std::queue<Cell> open;
  open.push({static_cast<int>(first), 0, 0, right, *across});
  taken[first] = true;
  while (!open.empty()) {
    const Cell cell = open.front();
    open.pop();
    cells.push_back(cell);
    const Vector2d& here = discs[static_cast<std::size_t>(cell.disc)].at;
    for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const Vector2d expected = dc * cell.right + dr * cell.down;
      const int next = nearest(discs, here + expected, kNear * expected.norm());
      if (next < 0 || taken[static_cast<std::size_t>(next)]) continue;
      taken[static_cast<std::size_t>(next)] = true;
      Cell found{next, cell.column + dc, cell.row + dr, cell.right, cell.down};
      const Vector2d found_offset = discs[static_cast<std::size_t>(next)].at - here;
      if (dc != 0) found.right = dc * found_offset;
      if (dr != 0) found.down = dr * found_offset;
      open.push(found);
    }
  }
  return cells;
}

/// Whether the cells fill the board, which may be rotated by 90 degrees; moves the indices to start
/// at 0.
bool fills(std::vector<Cell>& cells, const calibration::BoardSpec& board) {
  if (static_cast<int>(cells.size()) != board.columns * board.rows) return false;
  const auto [left, right] = std::ranges::minmax(cells, {}, &Cell::column);
  const auto [top, bottom] = std::ranges::minmax(cells, {}, &Cell::row);
  const int columns = right.column - left.column + 1;
  const int rows = bottom.row - top.row + 1;
  const int first_column = left.column;
  const int first_row = top.row;
  for (Cell& cell : cells) {
    cell.column -= first_column;
    cell.row -= first_row;
    if (columns != board.columns) std::swap(cell.column, cell.row);
  }
  return (columns == board.columns && rows == board.rows) ||
         (columns == board.rows && rows == board.columns);
}

std::optional<calibration::BoardView> boardIn(const optics::GreyView& picture,
                                              const calibration::BoardSpec& board) {
  const std::vector<Disc> discs = discsIn(picture);
  std::vector<bool> tried(discs.size(), false);
  for (std::size_t first = 0; first < discs.size(); ++first) {
    if (tried[first]) continue;
    std::vector<Cell> cells = gridFrom(discs, first);
    for (const Cell& cell : cells) tried[static_cast<std::size_t>(cell.disc)] = true;
    if (!fills(cells, board)) continue;
    calibration::BoardView view;
    view.disc_radius = board.discRadius();
    for (const Cell& cell : cells) {
      const Disc& disc = discs[static_cast<std::size_t>(cell.disc)];
      view.points.push_back({board.spacing * cell.column,
                             board.spacing * cell.row,
                             {disc.at[0], disc.at[1]},
                             disc.sigma});
    }
    return view;
  }
  return std::nullopt;
}

}  // namespace

std::optional<calibration::BoardView> findBoard(const optics::GreyView& picture,
                                                const calibration::BoardSpec& board) {
  if (auto view = boardIn(picture, board)) return view;
  optics::CameraResponse encoded(optics::kVideoGamma);
  return boardIn(encoded.linear(picture), board);
}

}  // namespace lab::runner
