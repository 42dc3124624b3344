/// The cheapest way to give rows partners: the assignment problem, with the price of every doubt.
#pragma once

#include <cstddef>
#include <vector>

namespace lab::tracker {

/// Rows (tracks) get one column (detection) each or stay alone at a price of their own; a column
/// serves one row or none. Shortest augmenting paths (Jonker and Volgenant 1987), dense, O(rows^2
/// columns): made for the few rows that are not settled otherwise. Keeps its memory.
class Assignment {
 public:
  /// No pair allowed yet; staying alone costs nothing.
  void reset(std::size_t rows, std::size_t columns);

  /// Allows a pair at a price.
  void allow(std::size_t row, std::size_t column, double cost) { cost_[at(row, column)] = cost; }

  /// The price of a row without a column.
  void setAlone(std::size_t row, double cost) { cost_[at(row, columns_ + row)] = cost; }

  void solve();

  /// The column of a row, -1: none. After solve().
  [[nodiscard]] int columnOf(std::size_t row) const {
    return column_of_[row] < columns_ ? static_cast<int>(column_of_[row]) : -1;
  }

  /// How much dearer everything becomes, at best, if this row does not get what solve() gave it:
  /// the logarithm of a likelihood ratio where costs are negative log likelihoods. Infinite where
  /// nothing else is allowed.
  [[nodiscard]] double margin(std::size_t row);

 private:
  [[nodiscard]] std::size_t at(std::size_t row, std::size_t column) const {
    return row * (columns_ + rows_) + column;
  }
  double shortestPath(std::size_t start, std::size_t target);

  std::size_t rows_ = 0;
  std::size_t columns_ = 0;  ///< then follows one column per row, for staying alone
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
