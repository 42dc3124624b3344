#include "sim_svc/camera/camera_painter_cells.hpp"

#include <cmath>

namespace lab::sim::painter {
namespace {

/// out[i] += tap (a[i] + b[i])
LAB_TARGET_CLONES
void addPair(float tap, const float* __restrict a, const float* __restrict b, float* __restrict out,
             int count) {
  for (int i = 0; i < count; ++i) out[i] += tap * (a[i] + b[i]);
}

LAB_TARGET_CLONES
void split(const float* __restrict both, float* __restrict even, float* __restrict odd, int count) {
  for (int i = 0; i < count; ++i) {
    even[i] = both[2 * i];
    odd[i] = both[2 * i + 1];
  }
}

}  // namespace

PointSpread::PointSpread(double blur) {
  // The pixel's square is two cells wide. Sampled at whole cells, a Gaussian of 1.5 cells is exact
  // to 1e-19 of its transform; a Gaussian far below a cell reduces to the cell itself.
  const double sigma = std::max(2 * blur, 0.2);
  const int most = static_cast<int>(std::ceil(3.7 * sigma));
  const auto gauss = [&](int offset) { return std::exp(-0.5 * offset * offset / (sigma * sigma)); };
  double sum = 0;
  for (int offset = -most; offset <= most; ++offset) sum += gauss(offset);
  for (int k = 0; k <= most; ++k) {
    const double outer = k + 1 <= most ? gauss(k + 1) : 0;
    taps_.push_back(static_cast<float>(0.5 * (gauss(k) + outer) / sum));
  }
  reach_ = (most + 2) / 2;
}

void PointSpread::apply(const Lattice& lattice, const float* cells, const Box& box, float* out) {
  if (box.empty()) return;
  const int taps = static_cast<int>(taps_.size());
  const Box needed = lattice.cells(box.grown(reach_));
  const auto columns = static_cast<std::size_t>(needed.width());
  column_.resize(columns);
  even_.resize(columns / 2);
  odd_.resize(columns / 2);
  for (int y = box.y0; y < box.y1; ++y) {
    std::fill(column_.begin(), column_.end(), 0.0F);
    const int below = 2 * (y + lattice.margin);  // the first of the pixel's two rows
    for (int k = 0; k < taps; ++k) {
      addPair(taps_[static_cast<std::size_t>(k)], cells + lattice.at(needed.x0, below - k),
              cells + lattice.at(needed.x0, below + 1 + k), column_.data(), needed.width());
    }
    split(column_.data(), even_.data(), odd_.data(), needed.width() / 2);
    float* row = out + static_cast<std::ptrdiff_t>(y) * lattice.width + box.x0;
    std::fill_n(row, box.width(), 0.0F);
    for (int k = 0; k < taps; ++k) {
      // Left of the pixel's middle lies cell 2x - k, right of it 2x + 1 + k.
      const int left = reach_ - (k + 1) / 2;
      const int right = reach_ + (k + 1) / 2;
      const float* a = (k % 2 == 0 ? even_.data() : odd_.data()) + left;
      const float* b = (k % 2 == 0 ? odd_.data() : even_.data()) + right;
      addPair(taps_[static_cast<std::size_t>(k)], a, b, row, box.width());
    }
  }
}

}  // namespace lab::sim::painter
