#include "tracker_svc/circle_fit/circle_fit_edge_guess.hpp"

#include <algorithm>
#include <cmath>

namespace lab::detector::fit {
namespace {

constexpr int kAngles = 12;       // over 90 degrees: each angle also gives the perpendicular lines
constexpr int kBins = 20;         // across the window
constexpr float kOutside = 1.2F;  // [sigma] from the outline to the purely white pixels
constexpr float kLeastPixels = 4;

struct Pile {
  float count = 0;
  float sum = 0;
  Pile operator-(const Pile& o) const { return {count - o.count, sum - o.sum}; }
  Pile operator+(const Pile& o) const { return {count + o.count, sum + o.sum}; }
  // Reduction of the sum of squares by a level of its own.
  [[nodiscard]] float gain() const { return count > 0 ? sum * sum / count : 0; }
  [[nodiscard]] float level(float otherwise) const { return count > 0 ? sum / count : otherwise; }
};

// piles[i][j]: sum over the first i columns and the first j rows of bins.
struct Table {
  Pile piles[kBins + 1][kBins + 1] = {};
};

struct Best {
  float gain = 0;
  Line normal;
  int first = 0, second = 0;
  std::array<float, 4> level{};
};

bool enough(const Pile& a, const Pile& b) {
  return a.count >= kLeastPixels && b.count >= kLeastPixels;
}

// Lines across the columns (transposed: across the rows) of a table.
template <typename AtMost>
void tryOne(const AtMost& below, const Line& normal, Best& one) {
  const Pile all = below(kBins);
  for (int i = 1; i < kBins; ++i) {
    const Pile low = below(i);
    const Pile high = all - low;
    const float gain = low.gain() + high.gain();
    if (gain > one.gain && enough(low, high)) {
      one = {gain, normal, i, 0, {low.level(0), high.level(0), 0, 0}};
    }
  }
}

template <typename AtMost>
void tryParallel(const AtMost& below, const Line& normal, Best& parallel) {
  const Pile all = below(kBins);
  for (int i = 1; i < kBins; ++i) {
    const Pile low = below(i);
    for (int j = i + 1; j < kBins; ++j) {
      const Pile middle = below(j) - low;
      const Pile last = all - below(j);
      const float gain = low.gain() + middle.gain() + last.gain();
      if (gain <= parallel.gain || !enough(middle, last) || !enough(low, last)) continue;
      parallel = {
          gain, normal, i, j, {low.level(0), middle.level(0), middle.level(0), last.level(0)}};
    }
  }
}

void tryCrossing(const Table& table, const Line& normal, Best& crossing) {
  const auto& p = table.piles;
  const Pile all = p[kBins][kBins];
  for (int i = 1; i < kBins; ++i) {
    for (int j = 1; j < kBins; ++j) {
      const Pile a = p[i][j];
      const Pile b = p[kBins][j] - a;
      const Pile c = p[i][kBins] - a;
      const Pile d = all - a - b - c;
      const float gain = a.gain() + b.gain() + c.gain() + d.gain();
      if (gain <= crossing.gain) continue;
      if (!enough(a + c, b + d) || !enough(a + b, c + d)) continue;
      const float mean = all.level(0);
      crossing = {gain, normal, i, j, {a.level(mean), b.level(mean), c.level(mean), d.level(mean)}};
    }
  }
}

// Rotation by 90 degrees / kAngles, as constants: the library's sine may differ in the last bit
// between processors.
constexpr float kCosine = 0.991444861F;  // of 7.5 degrees
constexpr float kSine = 0.130526192F;

Line turned(const Line& n) {
  Line out = n;
  out.nx = kCosine * n.nx - kSine * n.ny;
  out.ny = kSine * n.nx + kCosine * n.ny;
  return out;
}

Line across(const Line& n) { return {-n.ny, n.nx, 0}; }

EdgeGuess splitOf(const Best& best, bool crossing, float reach, const Pile& all) {
  const auto offset = [&](int bin) {
    return static_cast<float>(bin) * 2 * reach / static_cast<float>(kBins) - reach;
  };
  EdgeGuess split;
  split.good = best.gain > 0;
  split.gain = best.gain - all.gain();
  split.line = {best.normal, crossing ? across(best.normal) : best.normal};
  split.line[0].offset = offset(best.first);
  split.line[1].offset = offset(best.second);
  split.level = best.level;
  return split;
}

int binOf(float along, float reach) {
  const float bins_per_px = static_cast<float>(kBins) / (2 * reach);
  return std::clamp(static_cast<int>((along + reach) * bins_per_px), 0, kBins - 1);
}

}  // namespace

Surroundings::Surroundings(const Window& window, const Constants& constants, const Disc& disc,
                           Pick pick) {
  const float outside = constants.radius * disc.scale + kOutside * disc.sigma;
  for (int i = 0; i < window.count; ++i) {
    const float dx = window.x[i] - disc.x;
    const float dy = window.y[i] - disc.y;
    if (pick == Pick::kWellFitted && window.residual[i] == 0.0F) continue;
    if (window.value[i] < 0 || constants.outline.squareAt(dx, dy) < outside * outside) continue;
    samples_[static_cast<std::size_t>(count_++)] = {window.x[i], window.y[i],
                                                    window.value[i] - constants.black};
    reach_ = std::max(reach_, window.x[i] * window.x[i] + window.y[i] * window.y[i]);
  }
  reach_ = std::sqrt(reach_) + 0.01F;
}

bool Surroundings::uneven(float variance) const {
  // [variances] the best of many lines gains up to 15 by chance
  constexpr float kBeyondChance = 25;
  constexpr float kLeastStep = 0.04F;  // [1] of the brighter level
  const EdgeGuess split = oneLine();
  if (!split.good) return true;  // too few pixels to decide
  const float bright = std::max(split.level[0], split.level[1]);
  const float step = std::abs(split.level[0] - split.level[1]);
  return split.gain > kBeyondChance * variance && step > kLeastStep * bright;
}

EdgeGuess Surroundings::oneLine() const {
  Best one;
  Line normal;
  for (int k = 0; k < 2 * kAngles; ++k, normal = turned(normal)) {
    std::array<Pile, kBins + 1> piles{};
    for (int i = 0; i < count_; ++i) {
      const Sample& s = samples_[static_cast<std::size_t>(i)];
      Pile& pile =
          piles[static_cast<std::size_t>(binOf(normal.nx * s.x + normal.ny * s.y, reach_) + 1)];
      pile = pile + Pile{1, s.light};
    }
    for (std::size_t i = 1; i < piles.size(); ++i) piles[i] = piles[i] + piles[i - 1];
    tryOne([&](int i) { return piles[static_cast<std::size_t>(i)]; }, normal, one);
  }
  Pile all;
  for (int i = 0; i < count_; ++i) all = all + Pile{1, samples_[static_cast<std::size_t>(i)].light};
  return splitOf(one, false, reach_, all);
}

TwoEdgeGuesses Surroundings::twoLines() const {
  Best parallel;
  Best crossing;
  Pile all;
  Line normal;
  for (int k = 0; k < kAngles; ++k, normal = turned(normal)) {
    Table table;
    auto& p = table.piles;
    for (int i = 0; i < count_; ++i) {
      const Sample& s = samples_[static_cast<std::size_t>(i)];
      Pile& pile = p[binOf(normal.nx * s.x + normal.ny * s.y, reach_) + 1]
                    [binOf(normal.nx * s.y - normal.ny * s.x, reach_) + 1];
      pile = pile + Pile{1, s.light};
    }
    for (int i = 1; i <= kBins; ++i) {
      for (int j = 1; j <= kBins; ++j) {
        p[i][j] = p[i][j] + p[i - 1][j] + p[i][j - 1] - p[i - 1][j - 1];
      }
    }
    tryParallel([&](int i) { return p[i][kBins]; }, normal, parallel);
    tryParallel([&](int i) { return p[kBins][i]; }, across(normal), parallel);
    tryCrossing(table, normal, crossing);
    all = p[kBins][kBins];
  }
  return {splitOf(parallel, false, reach_, all), splitOf(crossing, true, reach_, all)};
}

}  // namespace lab::detector::fit
