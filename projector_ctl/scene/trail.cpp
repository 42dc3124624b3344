#include "projector_ctl/scene/trail.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "common/math/units.hpp"

namespace lab::projector {
namespace {

constexpr double kLargestShare = 0.2;  // share of a cell that diffuses to each neighbour per step
constexpr double kNothing = 1e-200;    // smaller values are set to 0: denormals are slow
constexpr double kMostSubSteps = 500;  // from about here on, taking them at once is faster
constexpr std::int64_t kStridesAtOnce = 8;

using units::seconds;

/// The smallest side of cells such that columns and rows are within an image's limits and there are
/// at most `most` cells.
double cellFor(double width, double height, std::size_t most) {
  double cell = std::max(width / light::kMostColumns, height / light::kMostRows);
  const auto cells = [&] {
    return std::ceil(width / cell - 1e-9) * std::ceil(height / cell - 1e-9);
  };
  while (cells() > static_cast<double>(most)) cell *= 1.01;
  return cell;
}

int cellsAlong(double length, double cell) {
  return std::max(1, static_cast<int>(std::ceil(length / cell - 1e-9)));
}

/// The modes of diffusion between walls, as an orthogonal matrix: row k is cos(pi k (i + 1/2) / n).
std::vector<double> modesOf(std::size_t count) {
  const auto n = static_cast<double>(count);
  std::vector<double> modes;
  modes.reserve(count * count);
  for (std::size_t k = 0; k < count; ++k) {
    const double scale = std::sqrt((k == 0 ? 1 : 2) / n);
    for (std::size_t i = 0; i < count; ++i) {
      const double phase = static_cast<double>(k) * (static_cast<double>(i) + 0.5) / n;
      modes.push_back(scale * std::cos(std::numbers::pi * phase));
    }
  }
  return modes;
}

std::vector<double> transposed(const std::vector<double>& matrix, std::size_t width) {
  const std::size_t height = matrix.size() / width;
  std::vector<double> result(matrix.size());
  for (std::size_t row = 0; row < height; ++row) {
    for (std::size_t i = 0; i < width; ++i) result[i * height + row] = matrix[row * width + i];
  }
  return result;
}

/// Multiplies each row by a square matrix, and transposes the result.
std::vector<double> transformed(const std::vector<double>& rows, const std::vector<double>& matrix,
                                std::size_t width) {
  const std::size_t height = rows.size() / width;
  std::vector<double> result(rows.size());
  for (std::size_t k = 0; k < width; ++k) {
    const double* factors = &matrix[k * width];
    for (std::size_t row = 0; row < height; ++row) {
      result[k * height + row] =
          std::inner_product(factors, factors + width, &rows[row * width], 0.0);
    }
  }
  return result;
}

/// sin^2(pi k / 2n): a step multiplies the mode (k, l) by 1 - 4 share (this of k + this of l).
std::vector<double> ratesOf(std::size_t count) {
  std::vector<double> rates;
  for (std::size_t k = 0; k < count; ++k) {
    const double phase = static_cast<double>(k) / (2 * static_cast<double>(count));
    const double sine = std::sin(std::numbers::pi * phase);
    rates.push_back(sine * sine);
  }
  return rates;
}

}  // namespace

Trail::Trail(const Settings& settings)
    : settings_(settings),
      cell_(cellFor(settings.width, settings.height, settings.most_cells)),
      columns_(cellsAlong(settings.width, cell_)),
      rows_(cellsAlong(settings.height, cell_)),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
      buffer_(cells_.size()) {}

double Trail::source() const {
  return settings_.rate * std::numbers::pi * settings_.radius * settings_.radius / 3;
}

double Trail::mass() const {
  return cell_ * cell_ * std::accumulate(cells_.begin(), cells_.end(), 0.0);
}

void Trail::spread(Cells& cells, double share) {
  const auto width = static_cast<std::size_t>(columns_);
  const auto height = static_cast<std::size_t>(rows_);
  for (std::size_t row = 0; row < height; ++row) {
    const double* here = &cells[row * width];
    const double* below = row > 0 ? here - width : here;
    const double* above = row + 1 < height ? here + width : here;
    double* out = &buffer_[row * width];
    const auto cellAt = [&](std::size_t i, std::size_t left, std::size_t right) {
      out[i] = here[i] + share * (((here[left] - here[i]) + (here[right] - here[i])) +
                                  ((below[i] - here[i]) + (above[i] - here[i])));
    };
    cellAt(0, 0, std::min<std::size_t>(1, width - 1));
    for (std::size_t i = 1; i + 1 < width; ++i) cellAt(i, i - 1, i + 1);
    if (width > 1) cellAt(width - 1, width - 2, width - 1);
  }
  cells.swap(buffer_);
}

// The steps multiply each mode by the power of one factor. Its magnitude is below 1 but for the
// mean, which they keep, so that after any time the field is finite, and flat after a long one.
void Trail::spreadAtOnce(Cells& cells, double share, double steps) const {
  const auto width = static_cast<std::size_t>(columns_);
  const auto height = static_cast<std::size_t>(rows_);
  const std::vector<double> along = modesOf(width);
  const std::vector<double> across = modesOf(height);
  std::vector<double> modes = transformed(transformed(cells, along, width), across, height);
  const std::vector<double> along_rates = ratesOf(width);
  const std::vector<double> across_rates = ratesOf(height);
  for (std::size_t l = 0; l < height; ++l) {
    for (std::size_t k = 0; k < width; ++k) {
      modes[l * width + k] *= std::pow(1 - 4 * share * (along_rates[k] + across_rates[l]), steps);
    }
  }
  cells = transformed(transformed(modes, transposed(along, width), width),
                      transposed(across, height), height);
  for (double& cell : cells) cell = std::max(0.0, cell);  // rounding
}

/// Lets a time [s] pass a number of times.
void Trail::pass(Cells& cells, double time, std::int64_t times) {
  const double shares = settings_.diffusion * time / (cell_ * cell_);
  const double steps = std::ceil(shares / kLargestShare);
  const double all = steps * static_cast<double>(times);
  if (all > kMostSubSteps) {
    spreadAtOnce(cells, shares / steps, all);
  } else {
    for (int step = 0; step < static_cast<int>(all); ++step) spread(cells, shares / steps);
  }
  const double kept = std::exp(-settings_.decay * time * static_cast<double>(times));
  if (kept < 1) {
    for (double& cell : cells) cell = cell > kNothing ? cell * kept : 0;
  }
}

void Trail::advanceTo(std::int64_t utime) {
  if (utime <= utime_) return;
  if (!empty_) pass(cells_, seconds(utime - utime_), 1);
  utime_ = utime;
  strides_ = 0;
}

void Trail::add(double x, double y, double amount) {
  const double radius = settings_.radius;
  const auto range = [&](double middle, int count) {
    const int first =
        std::clamp(static_cast<int>(std::floor((middle - radius) / cell_)), 0, count - 1);
    const int last =
        std::clamp(static_cast<int>(std::floor((middle + radius) / cell_)), 0, count - 1);
    return std::pair(first, last);
  };
  const auto [left, right] = range(x, columns_);
  const auto [bottom, top] = range(y, rows_);
  weights_.clear();
  double sum = 0;
  for (int row = bottom; row <= top; ++row) {
    const double dy = (row + 0.5) * cell_ - y;
    for (int column = left; column <= right; ++column) {
      const double dx = (column + 0.5) * cell_ - x;
      const double rest = std::max(0.0, 1 - (dx * dx + dy * dy) / (radius * radius));
      weights_.push_back(rest * rest);
      sum += rest * rest;
    }
  }
  const auto at = [&](int column, int row) -> double& {
    return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  };
  const double total = amount / (cell_ * cell_);
  if (sum <= 0) {
    // The source is smaller than a cell and contains no cell centre: use the nearest cell.
    const auto nearest = [&](double place, int count) {
      return std::clamp(static_cast<int>(std::floor(place / cell_)), 0, count - 1);
    };
    at(nearest(x, columns_), nearest(y, rows_)) += total;
    return;
  }
  std::size_t next = 0;
  for (int row = bottom; row <= top; ++row) {
    for (int column = left; column <= right; ++column) {
      at(column, row) += total * weights_[next++] / sum;
    }
  }
}

void Trail::lay(double from_x, double from_y, std::int64_t from_utime, double to_x, double to_y,
                std::int64_t to_utime) {
  if (to_utime <= from_utime) return;
  const double distance = std::hypot(to_x - from_x, to_y - from_y);
  // The path is divided into points that are at most half a cell and a fifth of the radius apart,
  // so that the trail has no visible beads.
  const double spacing = std::min(0.5 * cell_, 0.2 * settings_.radius);
  const int pieces = std::max(1, static_cast<int>(std::ceil(distance / spacing)));
  const double time = seconds(to_utime - from_utime) / pieces;
  const double oldest = seconds(utime_ - from_utime);
  // Integral of the decaying source over one piece, at the end of the piece.
  const double decay = settings_.decay;
  const double left = decay > 0 ? -std::expm1(-decay * time) / decay : time;
  for (int i = 0; i < pieces; ++i) {
    const double share = (i + 0.5) / pieces;
    const double age = oldest - (i + 1) * time;
    add(from_x + share * (to_x - from_x), from_y + share * (to_y - from_y),
        source() * left * std::exp(-decay * age));
  }
  empty_ = false;
  strides_ = 0;
}

std::shared_ptr<const light::Image> Trail::picture(std::int64_t utime) {
  const std::int64_t since = std::max<std::int64_t>(0, utime - utime_);
  const std::int64_t strides = empty_ ? 0 : since / kStride_us;
  // Blocks begin at the state itself, so that a picture costs little after any time and does not
  // depend on earlier ones.
  const std::int64_t blocks = strides - strides % kStridesAtOnce;
  if (strides > 0 && (strides_ == 0 || strides < strides_ || strides_ < blocks)) {
    carried_ = cells_;
    pass(carried_, seconds(kStride_us), blocks);
    strides_ = blocks;
  }
  for (; strides > 0 && strides_ < strides; ++strides_) pass(carried_, seconds(kStride_us), 1);
  const Cells& cells = strides > 0 ? carried_ : cells_;

  const double kept = std::exp(-settings_.decay * seconds(since - strides * kStride_us));
  light::Image image;
  image.columns = columns_;
  image.rows = rows_;
  image.grey.resize(cells.size());
  const auto width = static_cast<std::size_t>(columns_);
  std::size_t next = 0;
  for (std::size_t row = static_cast<std::size_t>(rows_); row-- > 0;) {
    for (std::size_t i = 0; i < width; ++i) {
      const double shown = std::min(1.0, kept * cells[row * width + i]);
      image.grey[next++] = static_cast<std::uint8_t>(255 * shown + 0.5);
    }
  }
  if (!picture_ || picture_->grey != image.grey) {
    picture_ = std::make_shared<const light::Image>(std::move(image));
  }
  return picture_;
}

}  // namespace lab::projector
