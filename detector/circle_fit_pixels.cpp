#include "detector/circle_fit_pixels.hpp"

#include <algorithm>
#include <cmath>

#include "detector/circle_fit_lanes.hpp"
#include "detector/circle_fit_solve.hpp"

namespace lab::detector::fit {
namespace {

// The rough step looks no farther outside the outline, where holes would draw it.
constexpr double kRoughReach = 1.8;  // [sigma]
constexpr double kBeyond = 1.0;      // [px] of the outline may lie outside the picture

// Outlines that differ by less are of one kind: it decides where pixels are looked at, and the
// start of the fit, but not what is fitted.
constexpr float kSizes = 6;  // half widths and heights a pixel
constexpr float kSkews = 8;
constexpr float kBlurs = 8;
constexpr float kMargins = 8;
constexpr std::size_t kKept = 256;

// The slopes of a pixel's value by x, y, white and dark, at a place relative to the disc.
std::array<double, 4> slopesAt(double dx, double dy, const double* m, double radius,
                               double sigma) {
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

const std::shared_ptr<const Pixels>& Pixels::about(const DiscShape& shape, float sigma,
                                                   float margin) {
  const float* m = shape.m;
  const float a = m[0] * m[0] + m[2] * m[2];
  const float b = m[0] * m[1] + m[2] * m[3];
  const float c = m[1] * m[1] + m[3] * m[3];
  const float over = 1.0F / (a * c - b * b);
  const auto steps = [](float value, float per_unit) {
    return floorOf(value * per_unit + 0.5F);
  };
  const Kind kind{std::max(2, steps(std::sqrt(c * over), kSizes)),
                  std::max(2, steps(std::sqrt(a * over), kSizes)),
                  steps(-b / std::sqrt(a * c), kSkews), std::max(1, steps(sigma, kBlurs)),
                  std::max(1, steps(margin, kMargins))};
  thread_local std::array<std::shared_ptr<const Pixels>, kKept> kept;
  const auto place = static_cast<std::size_t>(kind.width + 5 * kind.height + 67 * kind.skew +
                                              31 * kind.blur + 127 * kind.margin);
  std::shared_ptr<const Pixels>& found = kept[place % kKept];
  if (!found || !(found->kind_ == kind)) found.reset(new Pixels(kind));
  return found;
}

Pixels::Ellipse::Ellipse(const Kind& kind)
    : reach_x(static_cast<double>(static_cast<float>(kind.width) / kSizes)),
      reach_y(static_cast<double>(static_cast<float>(kind.height) / kSizes)) {
  const double skew = std::clamp(static_cast<double>(static_cast<float>(kind.skew) / kSkews),
                                 -0.95, 0.95);
  const double high = 1 / std::sqrt(1 - skew * skew);
  m[0] = high / reach_x;
  m[1] = -skew * high / reach_y;
  m[2] = 0;
  m[3] = 1 / reach_y;
  radius = 1 / std::sqrt(m[0] * m[3]);
}

Pixels::Pixels(const Kind& kind) : kind_(kind), ellipse_(kind) {
  for (int phase = 0; phase < 4; ++phase) {
    phases_[static_cast<std::size_t>(phase)] =
        phaseOf(ellipse_, static_cast<double>(static_cast<float>(kind.blur) / kBlurs),
                static_cast<double>(static_cast<float>(kind.margin) / kMargins),
                kGrid * (phase & 1), kGrid * (phase >> 1));
  }
}

std::vector<Pixels::Span> Pixels::spansWithin(const Ellipse& ellipse, double margin,
                                              double shift_x, double shift_y) {
  const double* m = ellipse.m;
  const double widened = 1 + margin / ellipse.radius;
  const int box_x = static_cast<int>(std::ceil(ellipse.reach_x * widened)) + 1;
  const int box_y = static_cast<int>(std::ceil(ellipse.reach_y * widened)) + 1;
  // Very large circles: every other row, or fewer, tells enough.
  const int row_step = 1 + 4 * box_x * box_y / kMostPixels;
  const double a = m[0] * m[0] + m[2] * m[2];
  const double b = m[0] * m[1] + m[2] * m[3];
  std::vector<Span> spans;
  for (int row = -box_y; row <= box_y; row += row_step) {
    // a dx^2 + 2 b dx dy + c dy^2 < widened^2
    const double dy = row - shift_y;
    const double inside = a * widened * widened - dy * dy * std::pow(m[0] * m[3], 2);
    if (inside <= 0) continue;
    const double half = std::sqrt(inside) / a;
    const double middle = shift_x - b * dy / a;
    const int from = static_cast<int>(std::ceil(middle - half));
    const int to = static_cast<int>(std::floor(middle + half));
    if (to >= from) spans.push_back({from, row, to - from + 1});
  }
  return spans;
}

Pixels::Phase Pixels::phaseOf(const Ellipse& ellipse, double sigma, double margin, double shift_x,
                              double shift_y) {
  Phase out;
  out.spans = spansWithin(ellipse, margin, shift_x, shift_y);
  for (const Span& span : out.spans) {
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
  addRuns(ellipse, sigma, shift_x, shift_y, out);
  return out;
}

void Pixels::addRuns(const Ellipse& ellipse, double sigma, double shift_x, double shift_y,
                     Phase& phase) {
  std::array<double, 10> normal{};
  for (const Span& span : spansWithin(ellipse, kRoughReach * sigma, shift_x, shift_y)) {
    for (int first = 0; first < span.count; first += kLanes) {
      Run run{span.dx + first, span.dy, {}};
      for (int lane = 0; lane < std::min(kLanes, span.count - first); ++lane) {
        const std::array<double, 4> by = slopesAt(run.dx + lane - shift_x, run.dy - shift_y,
                                                  ellipse.m, ellipse.radius, sigma);
        std::size_t pair = 0;
        for (std::size_t i = 0; i < by.size(); ++i) {
          run.weight[i][lane] = static_cast<float>(by[i]);
          for (std::size_t j = 0; j <= i; ++j) normal[pair++] += by[i] * by[j];
        }
      }
      phase.runs.push_back(run);
      phase.left = std::min(phase.left, run.dx);
      phase.right = std::max(phase.right, run.dx + kLanes - 1);
      phase.top = std::min(phase.top, run.dy);
      phase.bottom = std::max(phase.bottom, run.dy);
    }
  }
  const Factor<4> factor(normal);
  for (Run& run : phase.runs) {
    for (int lane = 0; lane < kLanes; ++lane) {
      std::array<double, 4> by{};
      for (std::size_t i = 0; i < by.size(); ++i) by[i] = static_cast<double>(run.weight[i][lane]);
      if (factor.good()) by = factor.solve(by);
      for (std::size_t i = 0; i < by.size(); ++i) run.weight[i][lane] = static_cast<float>(by[i]);
    }
  }
}

bool Pixels::Phase::within(const optics::GreyView& picture, int at_x, int at_y) const {
  return at_x + left >= 0 && at_x + right < picture.width && at_y + top >= 0 &&
         at_y + bottom < picture.height;
}

LAB_FIT_CLONES
void Pixels::sum(const optics::GreyView& picture, const Phase& phase, int x, int y, double* sums) {
  Lanes lanes[4] = {};
  const auto add = [&](const Run& run, const Lanes& value) LAB_INLINE_LAMBDA {
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) lanes[i] += loadLanes(run.weight[i]) * value;
  };
  if (phase.within(picture, x, y)) {
    const std::uint8_t* at = picture.row(y) + x;
    for (const Run& run : phase.runs) add(run, numbers(at + run.dy * picture.stride + run.dx));
  } else {
    for (const Run& run : phase.runs) {
      const std::uint8_t* row = picture.row(std::clamp(y + run.dy, 0, picture.height - 1));
      Lanes value;
      for (int lane = 0; lane < kLanes; ++lane) {
        value[lane] = row[std::clamp(x + run.dx + lane, 0, picture.width - 1)];
      }
      add(run, value);
    }
  }
  totals(lanes, sums);
}

Pixels::Rough Pixels::rough(const optics::GreyView& picture, const GridPoint& point) const {
  double sums[4];
  sum(picture, phaseAt(point), point.x >> 1, point.y >> 1, sums);
  return {sums[0], sums[1], sums[2], sums[3]};
}

LAB_FIT_CLONES
void Pixels::take(const optics::GreyView& picture, const Phase& phase, int x, int y,
                  Window& window) {
  // Whole eights: what is too much is written over by the next row.
  Lanes brightest = {};
  float* to = window.value;
  for (const Span& span : phase.spans) {
    const std::uint8_t* from = picture.row(y + span.dy) + x + span.dx;
    for (int at = 0; at < span.count; at += kLanes) storeLanes(to + at, numbers(from + at));
    to += span.count;
  }
  for (int at = 0; at + kLanes < window.count; at += kLanes) {
    const Lanes value = loadLanes(window.value + at);
    brightest = value > brightest ? value : brightest;
  }
  window.plain = true;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (brightest[lane] > kNearlyFull) window.plain = false;
  }
}

bool Pixels::gather(const optics::GreyView& picture, const GridPoint& point,
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
    take(picture, phase, x, y, window);
  } else {
    window.plain = false;
    float* to = window.value;
    for (const Span& span : phase.spans) {
      const int row = y + span.dy;
      for (int column = x + span.dx; column < x + span.dx + span.count; ++column) {
        const bool some =
            row >= 0 && row < picture.height && column >= 0 && column < picture.width;
        *to++ = some ? static_cast<float>(picture.row(row)[column]) : kNoPixel;
      }
    }
  }
  std::fill(window.value + phase.count, window.value + window.count, kNoPixel);
  return true;
}

}  // namespace lab::detector::fit
