/// The linear assignment problem, with the cost margin of each assignment.
#pragma once

#include <cstddef>
#include <vector>

namespace lab::tracker {

/// Each row (track) gets one column (detection), or stays alone at a cost; each column serves at
/// most one row. Shortest augmenting paths (Jonker and Volgenant 1987), dense, O(rows^2 columns):
/// intended for the few rows that cannot be assigned otherwise. Reuses its memory.
class Assignment {
 public:
  /// Starts with no pair allowed; staying alone costs 0.
  void reset(std::size_t rows, std::size_t columns);

  /// Allows a pair at a cost.
  void allow(std::size_t row, std::size_t column, double cost) { cost_[at(row, column)] = cost; }

  /// Sets the cost of a row without a column.
  void setAlone(std::size_t row, double cost) { cost_[at(row, columns_ + row)] = cost; }

  void solve();

  /// The column of a row, -1 if none. Valid after solve().
  [[nodiscard]] int columnOf(std::size_t row) const {
    return column_of_[row] < columns_ ? static_cast<int>(column_of_[row]) : -1;
  }

  /// The increase of the minimum total cost if this row does not get the column from solve(). With
  /// negative log likelihoods as costs it is the log likelihood ratio to the best alternative.
  /// Infinite if no alternative is allowed.
  [[nodiscard]] double margin(std::size_t row);

 private:
  [[nodiscard]] std::size_t at(std::size_t row, std::size_t column) const {
    return row * (columns_ + rows_) + column;
  }
  double shortestPath(std::size_t start, std::size_t target);

  std::size_t rows_ = 0;
  std::size_t columns_ = 0;  ///< followed by one column per row, for staying alone
  std::vector<double> cost_;
  std::vector<double> row_price_;
  std::vector<double> column_price_;
  std::vector<std::size_t> column_of_;
  std::vector<std::size_t> row_of_;
  std::vector<double> distance_;
  std::vector<std::size_t> from_;
  std::vector<char> done_;
  std::size_t end_ = 0;
};

}  // namespace lab::tracker
