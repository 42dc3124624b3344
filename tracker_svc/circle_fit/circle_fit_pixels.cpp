#include "tracker_svc/circle_fit/circle_fit_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "tracker_svc/circle_fit/circle_fit_lanes.hpp"
#include "tracker_svc/circle_fit/circle_fit_solve.hpp"

namespace lab::detector::fit {
namespace {

// The coarse step uses a narrow margin, because holes further out would attract it.
constexpr double kRoughReach = 1.8;     // [sigma]
constexpr std::size_t kMostRows = 200;  // if there are more, every second one is enough, or fewer
// including the padding of runs in that many rows
constexpr std::size_t kMostRough = 2 * kMostPixels;
constexpr double kBeyond = 1.0;  // [px] by which the outline may exceed the picture
// Sparse layout: pixels farther inside only determine black, which is known; pixels farther outside
// only determine the slope of the light, for which every second row is enough if the margin is
// wide. According to the model's covariance this increases the error of the centre by 0 to 2 %.
constexpr float kInside = 2;       // [sigma]
constexpr float kOutside = 1;      // [sigma]
constexpr float kAround = 3.4F;    // [sigma] margin from which it is wide
constexpr float kLeastMiddle = 1;  // [px] smallest half width of a middle worth omitting

// Outlines that differ by less share a layout. This affects which pixels are used and the start of
// the fit, but not the model.
constexpr float kSizes = 6;  // quantisation steps per pixel of half width and height
constexpr float kSkews = 8;
constexpr float kBlurs = 8;
constexpr float kMargins = 8;
constexpr std::size_t kKept = 512;
constexpr std::size_t kAside = 8;  // cache slots probed per kind

// Derivatives of a pixel's value by x, y, white and dark, at a position relative to the disc.
std::array<double, 4> slopesAt(double dx, double dy, const double* m, double radius, double sigma) {
  const double qx = radius * (m[0] * dx + m[1] * dy);
  const double qy = radius * (m[2] * dx + m[3] * dy);
  const double distance = std::sqrt(qx * qx + qy * qy + sigma * sigma);
  Lanes share;
  Lanes slope;
  edgeProfile(Lanes{} + static_cast<float>((distance - radius) / sigma), share, slope);
  const double outward = -radius * static_cast<double>(slope[0]) / (sigma * distance);
  const auto white = static_cast<double>(share[0]);
  return {(m[0] * qx + m[2] * qy) * outward, (m[1] * qx + m[3] * qy) * outward, white, 1 - white};
}

}  // namespace

const std::shared_ptr<const PixelLayout>& PixelLayout::about(const DiscShape& shape, float sigma,
                                                             float margin, bool sparse) {
  const float* m = shape.m;
  const float a = m[0] * m[0] + m[2] * m[2];
  const float b = m[0] * m[1] + m[2] * m[3];
  const float c = m[1] * m[1] + m[3] * m[3];
  const float over = 1.0F / (a * c - b * b);
  const auto steps = [](float value, float per_unit) { return floorOf(value * per_unit + 0.5F); };
  const Kind kind{std::max(2, steps(std::sqrt(c * over), kSizes)),
                  std::max(2, steps(std::sqrt(a * over), kSizes)),
                  steps(-b / std::sqrt(a * c), kSkews),
                  std::max(1, steps(sigma, kBlurs)),
                  std::max(1, steps(margin, kMargins)),
                  sparse && shape.radius() > kInside * sigma + kLeastMiddle};
  thread_local std::array<std::shared_ptr<const PixelLayout>, kKept> kept;
  const auto place =
      static_cast<std::size_t>(kind.width + 5 * kind.height + 67 * kind.skew + 31 * kind.blur +
                               127 * kind.margin + (kind.sparse ? 255 : 0));
  for (std::size_t aside = 0; aside < kAside; ++aside) {
    std::shared_ptr<const PixelLayout>& found = kept[(place + aside) % kKept];
    if (!found) found.reset(new PixelLayout(kind));
    if (found->kind_ == kind) return found;
  }
  std::shared_ptr<const PixelLayout>& other = kept[place % kKept];
  other.reset(new PixelLayout(kind));
  return other;
}

PixelLayout::Ellipse::Ellipse(const Kind& kind)
    : reach_x(static_cast<double>(static_cast<float>(kind.width) / kSizes)),
      reach_y(static_cast<double>(static_cast<float>(kind.height) / kSizes)) {
  const double skew =
      std::clamp(static_cast<double>(static_cast<float>(kind.skew) / kSkews), -0.95, 0.95);
  const double high = 1 / std::sqrt(1 - skew * skew);
  m[0] = high / reach_x;
  m[1] = -skew * high / reach_y;
  m[2] = 0;
  m[3] = 1 / reach_y;
  radius = 1 / std::sqrt(m[0] * m[3]);
}

PixelLayout::PixelLayout(const Kind& kind) : kind_(kind), ellipse_(kind) {
  for (int phase = 0; phase < 4; ++phase) {
    phases_[static_cast<std::size_t>(phase)] =
        phaseOf(kind, ellipse_, kGrid * (phase & 1), kGrid * (phase >> 1));
  }
}

PixelLayout::Span PixelLayout::rowWithin(const Ellipse& ellipse, double margin, int row,
                                         double shift_x, double shift_y) {
  const double* m = ellipse.m;
  const double widened = std::max(0.0, 1 + margin / ellipse.radius);
  // a dx^2 + 2 b dx dy + c dy^2 < widened^2
  const double a = m[0] * m[0] + m[2] * m[2];
  const double b = m[0] * m[1] + m[2] * m[3];
  const double dy = row - shift_y;
  const double inside = a * widened * widened - dy * dy * std::pow(m[0] * m[3], 2);
  if (inside <= 0) return {0, row, 0};
  const double half = std::sqrt(inside) / a;
  const double middle = shift_x - b * dy / a;
  const int from = static_cast<int>(std::ceil(middle - half));
  const int to = static_cast<int>(std::floor(middle + half));
  return {from, row, std::max(to - from + 1, 0)};
}

std::vector<PixelLayout::Span> PixelLayout::spansWithin(const Ellipse& ellipse, double margin,
                                                        double shift_x, double shift_y) {
  const double widened = 1 + margin / ellipse.radius;
  const int box_x = static_cast<int>(std::ceil(ellipse.reach_x * widened)) + 1;
  const int box_y = static_cast<int>(std::ceil(ellipse.reach_y * widened)) + 1;
  // For very large circles every second row, or fewer, is enough.
  const int row_step = 1 + 4 * box_x * box_y / kMostPixels;
  std::vector<Span> spans;
  for (int row = -box_y; row <= box_y; row += row_step) {
    const Span span = rowWithin(ellipse, margin, row, shift_x, shift_y);
    if (span.count > 0) spans.push_back(span);
  }
  return spans;
}

PixelLayout::Phase PixelLayout::phaseOf(const Kind& kind, const Ellipse& ellipse, double shift_x,
                                        double shift_y) {
  const double sigma = static_cast<double>(static_cast<float>(kind.blur) / kBlurs);
  const double margin = static_cast<double>(static_cast<float>(kind.margin) / kMargins);
  const double inside = -static_cast<double>(kInside) * sigma;
  const bool thin = kind.sparse && margin > static_cast<double>(kAround) * sigma;
  const double outside = thin ? static_cast<double>(kOutside) * sigma : margin;
  Phase out;
  const std::vector<Span> spans = spansWithin(ellipse, margin, shift_x, shift_y);
  const auto rows = static_cast<int>(spans.size());
  for (int row = 0; row < rows; ++row) {
    Span all = spans[static_cast<std::size_t>(row)];
    // Counted from the middle, so that opposite pixels are used too.
    const bool other = std::abs(2 * row - (rows - 1)) / 2 % 2 != 0;
    if (other) all = rowWithin(ellipse, outside, all.dy, shift_x, shift_y);
    if (all.count == 0) continue;
    const Span inner = rowWithin(ellipse, inside, all.dy, shift_x, shift_y);
    if (!kind.sparse || inner.count == 0) {
      out.spans.push_back(all);
    } else {
      out.middle.push_back(inner);
      out.spans.push_back({all.dx, all.dy, inner.dx - all.dx});
      out.spans.push_back({inner.end(), all.dy, all.end() - inner.end()});
    }
  }
  for (const Span& span : out.spans) {
    const int to = static_cast<int>(out.x.size());
    for (int i = 0; i < span.count; i += kLanes) {
      out.eights.push_back({span.dx + i, span.dy, to + i});
    }
    for (int i = 0; i < span.count; ++i) {
      out.x.push_back(static_cast<float>(span.dx + i - shift_x));
      out.y.push_back(static_cast<float>(span.dy - shift_y));
    }
    out.left = std::min(out.left, span.dx);
    out.right = std::max(out.right, span.dx + (span.count + kLanes - 1) / kLanes * kLanes - 1);
    out.top = std::min(out.top, span.dy);
    out.bottom = std::max(out.bottom, span.dy);
  }
  out.count = static_cast<int>(out.x.size());
  while (out.x.size() % kLanes != 0) {
    out.x.push_back(0);
    out.y.push_back(0);
  }
  addRough(ellipse, sigma, shift_x, shift_y, out);
  return out;
}

void PixelLayout::addRough(const Ellipse& ellipse, double sigma, double shift_x, double shift_y,
                           Phase& phase) {
  RoughSums& rough = phase.rough;
  std::vector<std::array<double, 4>> slopes;  // of all pixels of the runs
  std::array<double, 10> normal{};
  const std::vector<Span> spans = spansWithin(ellipse, kRoughReach * sigma, shift_x, shift_y);
  const std::size_t step = 1 + spans.size() / kMostRows;
  for (std::size_t row = 0; row < spans.size(); row += step) {
    const Span& span = spans[row];
    // One or two surplus pixels do not justify another run.
    const int runs = std::max(1, (span.count + kRun - 3) / kRun);
    const int count = std::min(span.count, runs * kRun);
    const int from = span.dx + (span.count - count) / 2;
    for (int i = 0; i < runs * kRun; ++i) {
      std::array<double, 4> by{};
      if (i < count) {
        by = slopesAt(from + i - shift_x, span.dy - shift_y, ellipse.m, ellipse.radius, sigma);
      }
      std::size_t pair = 0;
      for (std::size_t j = 0; j < by.size(); ++j) {
        for (std::size_t k = 0; k <= j; ++k) normal[pair++] += by[j] * by[k];
      }
      slopes.push_back(by);
    }
    for (int run = 0; run < runs; ++run) {
      rough.runs.push_back({from + run * kRun, span.dy});
    }
    phase.left = std::min(phase.left, from);
    phase.right = std::max(phase.right, from + runs * kRun - 1);
    phase.top = std::min(phase.top, span.dy);
    phase.bottom = std::max(phase.bottom, span.dy);
  }
  const Factor<4> factor(normal);
  if (factor.good()) {
    for (std::array<double, 4>& by : slopes) by = factor.solve(by);
  }
  for (std::size_t i = 0; i < rough.unit.size(); ++i) {
    double largest = 0;
    double all = 0;
    for (const std::array<double, 4>& by : slopes) {
      largest = std::max(largest, std::abs(by[i]));
      all += std::abs(by[i]);
    }
    // As fine as the ranges of weights and sums allow.
    constexpr double kLargest = std::numeric_limits<std::int16_t>::max();
    constexpr double kMostSum = std::numeric_limits<std::int32_t>::max() / 256.0 - kMostPixels;
    rough.unit[i] = std::max({largest / kLargest, all / kMostSum, 1e-12});
    for (const std::array<double, 4>& by : slopes) {
      rough.weights[i].push_back(static_cast<std::int16_t>(std::lround(by[i] / rough.unit[i])));
    }
  }
}

bool PixelLayout::Phase::within(const optics::GreyView& picture, int at_x, int at_y) const {
  return at_x + left >= 0 && at_x + right < picture.width && at_y + top >= 0 &&
         at_y + bottom < picture.height;
}

LAB_FIT_CLONES
void PixelLayout::sum(const optics::GreyView& picture, const Phase& phase, int x, int y,
                      std::int32_t* sums) {
  const RoughSums& rough = phase.rough;
  alignas(32) std::int16_t values[kMostRough];
  std::int16_t* to = values;
  if (phase.within(picture, x, y)) {
    const std::uint8_t* at = picture.row(y) + x;
    for (const Run& run : rough.runs) {
      const std::uint8_t* from = at + run.dy * picture.stride + run.dx;
      std::uint8_t __attribute__((vector_size(kRun))) bytes;
      std::memcpy(&bytes, from, sizeof bytes);
      using Shorts = std::int16_t __attribute__((vector_size(2 * kRun)));
      const auto shorts = __builtin_convertvector(bytes, Shorts);
      std::memcpy(to, &shorts, sizeof shorts);
      to += kRun;
    }
  } else {
    for (const Run& run : rough.runs) {
      const std::uint8_t* row = picture.row(std::clamp(y + run.dy, 0, picture.height - 1));
      for (int i = 0; i < kRun; ++i) {
        *to++ = row[std::clamp(x + run.dx + i, 0, picture.width - 1)];
      }
    }
  }
  const int count = static_cast<int>(rough.runs.size()) * kRun;
  const std::int16_t* by_x = rough.weights[0].data();
  const std::int16_t* by_y = rough.weights[1].data();
  const std::int16_t* white = rough.weights[2].data();
  const std::int16_t* dark = rough.weights[3].data();
  std::int32_t sum[4] = {};
  for (int i = 0; i < count; ++i) {
    sum[0] += values[i] * by_x[i];
    sum[1] += values[i] * by_y[i];
    sum[2] += values[i] * white[i];
    sum[3] += values[i] * dark[i];
  }
  std::copy(sum, sum + 4, sums);
}

PixelLayout::Rough PixelLayout::rough(const optics::GreyView& picture,
                                      const GridPoint& point) const {
  const Phase& phase = phaseAt(point);
  std::int32_t sums[4];
  sum(picture, phase, point.x >> 1, point.y >> 1, sums);
  const std::array<double, 4>& unit = phase.rough.unit;
  return {sums[0] * unit[0], sums[1] * unit[1], sums[2] * unit[2], sums[3] * unit[3]};
}

std::optional<float> PixelLayout::middle(const optics::GreyView& picture,
                                         const GridPoint& point) const {
  const Phase& phase = phaseAt(point);
  const int x = point.x >> 1;
  const int y = point.y >> 1;
  int sum = 0;
  int count = 0;
  // Every second row is enough for the darkness.
  for (std::size_t n = 0; n < phase.middle.size(); n += 2) {
    const Span& span = phase.middle[n];
    const int row = y + span.dy;
    if (row < 0 || row >= picture.height || x + span.dx < 0 || x + span.end() > picture.width) {
      return std::nullopt;
    }
    const std::uint8_t* from = picture.row(row) + x + span.dx;
    for (int i = 0; i < span.count; ++i) sum += from[i];
    count += span.count;
  }
  if (count == 0) return std::nullopt;
  return static_cast<float>(sum) / static_cast<float>(count);
}

LAB_FIT_CLONES
void PixelLayout::copyPixels(const optics::GreyView& picture, const Phase& phase, int x, int y,
                             Window& window) {
  Lanes brightest = {};
  float* to = window.value;
  const std::uint8_t* from = picture.row(y) + x;
  for (const Eight& eight : phase.eights) {
    storeLanes(to + eight.to, numbers(from + eight.dy * picture.stride + eight.dx));
  }
  for (int at = 0; at + kLanes < window.count; at += kLanes) {
    const Lanes value = loadLanes(window.value + at);
    brightest = value > brightest ? value : brightest;
  }
  window.plain = true;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (brightest[lane] > kNearlySaturated) window.plain = false;
  }
}

bool PixelLayout::gather(const optics::GreyView& picture, const GridPoint& point,
                         Window& window) const {
  const optics::Pixel base = point.pixel();
  if (base.x < ellipse_.reach_x - kBeyond ||
      base.x > picture.width - 1 - ellipse_.reach_x + kBeyond ||
      base.y < ellipse_.reach_y - kBeyond ||
      base.y > picture.height - 1 - ellipse_.reach_y + kBeyond) {
    return false;
  }
  const Phase& phase = phaseAt(point);
  window.base_x = base.x;
  window.base_y = base.y;
  window.count = static_cast<int>(phase.x.size());
  window.places = phase.count;
  window.x = phase.x.data();
  window.y = phase.y.data();
  const int x = point.x >> 1;
  const int y = point.y >> 1;
  if (phase.within(picture, x, y)) {
    copyPixels(picture, phase, x, y, window);
  } else {
    window.plain = true;
    float* to = window.value;
    for (const Span& span : phase.spans) {
      const int row = y + span.dy;
      for (int column = x + span.dx; column < x + span.dx + span.count; ++column) {
        const bool some = row >= 0 && row < picture.height && column >= 0 && column < picture.width;
        *to = some ? static_cast<float>(picture.row(row)[column]) : kNoPixel;
        window.plain = window.plain && some && *to <= kNearlySaturated;
        ++to;
      }
    }
  }
  std::fill(window.value + phase.count, window.value + window.count, kNoPixel);
  return true;
}

}  // namespace lab::detector::fit
