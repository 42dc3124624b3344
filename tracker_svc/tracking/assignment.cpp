#include "tracker_svc/tracking/assignment.hpp"

#include <limits>

namespace lab::tracker {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();

}  // namespace

void Assignment::reset(std::size_t rows, std::size_t columns) {
  rows_ = rows;
  columns_ = columns;
  cost_.assign(rows * (columns + rows), kNever);
  for (std::size_t row = 0; row < rows; ++row) setAlone(row, 0);
}

/// Dijkstra's algorithm over reduced costs, from a row to `target`, excluding the direct edge; with
/// target kNobody, to the nearest free column. Sets distance_, from_ (the row before each column),
/// done_ and end_.
/// @return the distance, infinite if there is no path
double Assignment::shortestPath(std::size_t start, std::size_t target) {
  const std::size_t width = columns_ + rows_;
  distance_.assign(width, kNever);
  from_.assign(width, kNobody);
  done_.assign(width, 0);
  std::size_t row = start;
  double reached = 0;
  while (true) {
    std::size_t next = kNobody;
    double nearest = kNever;
    // A free column may be exchanged for any other free column at the cost of its price: as if a
    // row with zero costs were assigned to every free column.
    const double* costs = row == kNobody ? nullptr : &cost_[at(row, 0)];
    const double price = row == kNobody ? 0 : row_price_[row];
    for (std::size_t column = 0; column < width; ++column) {
      if (done_[column] != 0) continue;
      if (row != start || column != target) {
        const double cost = costs == nullptr ? 0 : costs[column];
        const double length = reached + cost - price - column_price_[column];
        if (length < distance_[column]) {
          distance_[column] = length;
          from_[column] = row;
        }
      }
      if (distance_[column] < nearest) {
        nearest = distance_[column];
        next = column;
      }
    }
    if (next == kNobody) return kNever;
    done_[next] = 1;
    reached = nearest;
    end_ = next;
    row = row_of_[next];
    if (next == target || (target == kNobody && row == kNobody)) return reached;
  }
}

void Assignment::solve() {
  const std::size_t width = columns_ + rows_;
  row_price_.assign(rows_, 0);
  column_price_.assign(width, 0);
  column_of_.assign(rows_, kNobody);
  row_of_.assign(width, kNobody);
  for (std::size_t row = 0; row < rows_; ++row) {
    const double length = shortestPath(row, kNobody);  // the row's own column is always free
    row_price_[row] += length;
    for (std::size_t column = 0; column < width; ++column) {
      if (done_[column] == 0 || column == end_) continue;
      column_price_[column] += distance_[column] - length;
      row_price_[row_of_[column]] += length - distance_[column];
    }
    std::size_t column = end_;
    while (true) {
      const std::size_t giver = from_[column];
      const std::size_t before = column_of_[giver];
      row_of_[column] = giver;
      column_of_[giver] = column;
      if (giver == row) break;
      column = before;
    }
  }
}

double Assignment::margin(std::size_t row) {
  // The row releases its column. The additional cost is the shortest path that ends at this column,
  // used by another row or by none. Prices remain valid.
  return shortestPath(row, column_of_[row]);
}

}  // namespace lab::tracker
