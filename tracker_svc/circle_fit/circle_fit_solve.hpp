/// Small symmetric systems of fixed size. Internal to the circle fit.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace lab::detector::fit {

/// Two systems in parallel.
using DoublePair = double __attribute__((vector_size(16)));

inline bool isPositive(double v) { return v > 0; }
inline bool isPositive(const DoublePair& v) { return v[0] > 0 && v[1] > 0; }

/// Factors a symmetric matrix as L D L', without square roots; lower triangle row by row.
/// @tparam Number double, or DoublePair for two systems at once
template <std::size_t kCount, typename Number = double>
class Factor {
 public:
  using Vector = std::array<Number, kCount>;
  static constexpr std::size_t kPairs = kCount * (kCount + 1) / 2;

  /// good() returns false if the matrix is not positive definite.
  explicit Factor(const std::array<Number, kPairs>& normal) : l_(normal) {
    for (std::size_t i = 0; i < kCount; ++i) {
      Vector scaled;  // row i of L D
      for (std::size_t j = 0; j < i; ++j) {
        scaled[j] = at(i, j);
        for (std::size_t k = 0; k < j; ++k) scaled[j] -= scaled[k] * at(j, k);
        at(i, j) = scaled[j] * inverse_[j];
      }
      Number rest = at(i, i);
      for (std::size_t k = 0; k < i; ++k) rest -= scaled[k] * at(i, k);
      if (!isPositive(rest)) {
        good_ = false;
        return;
      }
      inverse_[i] = 1.0 / rest;
    }
  }

  [[nodiscard]] bool good() const { return good_; }

  [[nodiscard]] Vector solve(const Vector& right) const {
    Vector v = right;
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t k = 0; k < i; ++k) v[i] -= at(i, k) * v[k];
    }
    for (std::size_t i = kCount; i-- > 0;) {
      v[i] *= inverse_[i];
      for (std::size_t k = i + 1; k < kCount; ++k) v[i] -= at(k, i) * v[k];
    }
    return v;
  }

  /// One column of the inverse matrix.
  [[nodiscard]] Vector inverseColumn(std::size_t column) const {
    Vector unit;
    for (std::size_t i = 0; i < kCount; ++i) unit[i] = Number{} + (i == column ? 1.0 : 0.0);
    return solve(unit);
  }

 private:
  Number& at(std::size_t i, std::size_t j) { return l_[i * (i + 1) / 2 + j]; }
  [[nodiscard]] const Number& at(std::size_t i, std::size_t j) const {
    return l_[i * (i + 1) / 2 + j];
  }

  std::array<Number, kPairs> l_;
  std::array<Number, kCount> inverse_;  ///< of D; not zero-initialised, to save time
  bool good_ = true;
};

}  // namespace lab::detector::fit
