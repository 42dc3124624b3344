#include "sim_svc/world/disk_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "light/field/target_clones.hpp"

namespace lab::sim {
namespace {

constexpr std::size_t kBlock = 256;
constexpr double kLargestTaylor = 0.1;  // as in makeArcOf()

// makeArcOf() by its Taylor series, and DiskBodies::move(), without branches.
// @param centre x and y of each disk
LAB_TARGET_CLONES void moveBlock(std::size_t count, double* __restrict centre,
                                 double* __restrict theta, double* __restrict turned,
                                 double* __restrict heading_x, double* __restrict heading_y,
                                 const double* __restrict speed, const double* __restrict turn,
                                 const double* __restrict dt) {
  for (std::size_t i = 0; i < count; ++i) {
    const double dtheta = turn[i] * dt[i];
    const double half = dtheta / 2;
    const double h2 = half * half;
    const double h4 = h2 * h2;
    const double sine_over_half =
        1 - h2 * (1 / 6.0) + h4 * (1 / 120.0 - h2 * (1 / 5040.0) + h4 * (1 / 362880.0));
    const double cosine =
        1 - h2 * (1 / 2.0) + h4 * (1 / 24.0 - h2 * (1 / 720.0) + h4 * (1 / 40320.0));
    const double sine = half * sine_over_half;
    const double chord = speed[i] * dt[i] * sine_over_half;
    const double dx = chord * cosine;
    const double dy = chord * sine;
    const double cos_turn = 1 - 2 * sine * sine;
    const double sin_turn = 2 * sine * cosine;
    const double x = heading_x[i];
    const double y = heading_y[i];
    centre[2 * i] += x * dx - y * dy;
    centre[2 * i + 1] += y * dx + x * dy;
    theta[i] += dtheta;
    turned[i] += dtheta;
    heading_x[i] = x * cos_turn - y * sin_turn;
    heading_y[i] = y * cos_turn + x * sin_turn;
  }
}

// Whether the Taylor series holds for all of them.
LAB_TARGET_CLONES bool turnsLittle(std::size_t count, const double* turn, const double* dt) {
  std::int64_t far = 0;
  for (std::size_t i = 0; i < count; ++i) {
    far |= std::fabs(turn[i] * dt[i] / 2) < kLargestTaylor ? 0 : 1;
  }
  return far == 0;
}

}  // namespace

void DiskBodies::moveEach(std::size_t begin, std::size_t end, const double* dt) {
  for (std::size_t from = begin; from < end; from += kBlock) {
    const std::size_t count = std::min(kBlock, end - from);
    if (turnsLittle(count, &turn[from], dt + from)) {
      moveBlock(count, &centre[from].x, &theta[from], &turned[from], &heading_x[from],
                &heading_y[from], &speed[from], &turn[from], dt + from);
    } else {
      for (std::size_t i = from; i < from + count; ++i) move(i, dt[i]);
    }
  }
}

}  // namespace lab::sim
