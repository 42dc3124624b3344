/// Small symmetric systems of fixed size. Internal to the circle fit.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace lab::tracker::fit {

/// Cholesky factor of a symmetric matrix, lower triangle row by row.
template <std::size_t kCount>
class Factor {
 public:
  using Vector = std::array<double, kCount>;
  static constexpr std::size_t kPairs = kCount * (kCount + 1) / 2;

  /// good() is false where the matrix is not positive definite.
  explicit Factor(const std::array<double, kPairs>& normal) : l_(normal) {
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = at(i, j);
        for (std::size_t k = 0; k < j; ++k) sum -= at(i, k) * at(j, k);
        if (i == j) {
          if (!(sum > 0)) {
            good_ = false;
            return;
          }
          inverse_[i] = 1.0 / std::sqrt(sum);
        } else {
          at(i, j) = sum * inverse_[j];
        }
      }
    }
  }

  [[nodiscard]] bool good() const { return good_; }

  [[nodiscard]] Vector solve(const Vector& right) const {
    Vector v = right;
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t k = 0; k < i; ++k) v[i] -= at(i, k) * v[k];
      v[i] *= inverse_[i];
    }
    for (std::size_t i = kCount; i-- > 0;) {
      for (std::size_t k = i + 1; k < kCount; ++k) v[i] -= at(k, i) * v[k];
      v[i] *= inverse_[i];
    }
    return v;
  }

  /// One column of the inverse matrix.
  [[nodiscard]] Vector inverseColumn(std::size_t column) const {
    Vector unit;
    for (std::size_t i = 0; i < kCount; ++i) unit[i] = i == column ? 1 : 0;
    return solve(unit);
  }

 private:
  double& at(std::size_t i, std::size_t j) { return l_[i * (i + 1) / 2 + j]; }
  [[nodiscard]] const double& at(std::size_t i, std::size_t j) const {
    return l_[i * (i + 1) / 2 + j];
  }

  std::array<double, kPairs> l_;
  std::array<double, kCount> inverse_;  ///< of the diagonal; not set to zero, which takes time
  bool good_ = true;
};

}  // namespace lab::tracker::fit
