#include "tracker_svc/blobs/blob_ground.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "light/median.hpp"

namespace lab::detector {
namespace {

constexpr int kGreys = 256;
constexpr double kRounding = 1.0 / 12;      // [DN^2] variance of rounding to whole grey values
constexpr double kBeyond = 0.7;             // quantile
constexpr double kClear = 3;                // [1] standard deviations of the ground
constexpr int kEveryRow = 2;                // counted
constexpr double kSignificant = 5;          // [1] standard deviations
constexpr float kLeastShare = 0.1F;         // [1] contrast over the light of the ground
constexpr float kLeastContrast = 2;         // [DN]
constexpr double kLossyErrors = 1.6 * 1.6;  // [1] variance in compressed pictures, as for caps
constexpr double kMedianSquare = 0.4549;    // median of chi^2 of one degree of freedom

struct Pass {
  double quantile;
  bool masked;
};

int pixelsIn(const int* histogram) {
  int sum = 0;
  for (int grey = 0; grey < kGreys; ++grey) sum += histogram[grey];
  return sum;
}

/// A quantile of a histogram, between whole grey values.
float greyAt(const int* histogram, double share, int pixels) {
  const double half = share * pixels;
  int below = 0;
  for (int grey = 0; grey < kGreys; ++grey) {
    const int here = histogram[grey];
    if (here > 0 && below + here >= half) {
      return static_cast<float>(grey - 0.5 + (half - below) / here);
    }
    below += here;
  }
  return 0;
}

}  // namespace

std::vector<ColumnSpan> columnsOf(const optics::CameraModel& camera, double width, double height,
                                  double plane) {
  const optics::CameraParameters& p = camera.parameters();
  const auto rows = static_cast<std::size_t>(p.height);
  if (!(width > 0) || !(height > 0)) return std::vector<ColumnSpan>(rows, {0, p.width - 1});
  // The outline, in pieces so short that the lens does not bend them.
  constexpr int kPieces = 64;
  std::vector<optics::Pixel> outline;
  const std::array<optics::Place, 5> corners{
      {{0, 0}, {width, 0}, {width, height}, {0, height}, {}}};
  for (std::size_t side = 0; side < 4; ++side) {
    for (int i = 0; i < kPieces; ++i) {
      const double share = static_cast<double>(i) / kPieces;
      const optics::Place& a = corners[side];
      const optics::Place& b = corners[side + 1];
      outline.push_back(
          camera.project(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), plane));
    }
  }
  outline.push_back(outline.front());
  std::vector<ColumnSpan> spans(rows);
  for (int y = 0; y < p.height; ++y) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
      const optics::Pixel& a = outline[i];
      const optics::Pixel& b = outline[i + 1];
      if ((a.y <= y) == (b.y <= y)) continue;
      const double x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (!(low <= high)) continue;
    spans[static_cast<std::size_t>(y)] = {
        static_cast<int>(std::clamp(std::ceil(low), 0.0, static_cast<double>(p.width))),
        static_cast<int>(std::clamp(std::floor(high), -1.0, p.width - 1.0))};
  }
  return spans;
}

BlobGround::BlobGround(const optics::Imaging& imaging, std::vector<ColumnSpan> columns, int block)
    : imaging_(imaging), columns_(std::move(columns)), block_(block) {}

double BlobGround::variance(double grey) const {
  const double signal = std::max(0.0, grey - imaging_.black);
  return noise_ *
         (imaging_.read_noise * imaging_.read_noise + imaging_.shot_gain * signal + kRounding);
}

float BlobGround::threshold(float ground) const {
  const auto noise =
      static_cast<float>(kSignificant * std::sqrt(variance(static_cast<double>(ground))) / 3);
  const float light = ground - static_cast<float>(imaging_.black);
  return std::max({noise, kLeastShare * light, kLeastContrast});
}

void BlobGround::estimate(const optics::GreyView& picture, bool bright) {
  width_ = picture.width;
  height_ = picture.height;
  const auto size = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  ground_.resize(size);
  contrast_.resize(size);
  measureNoise(picture);
  // First quantiles beyond which blobs hardly reach; their error, in uneven light, from what is
  // left when the ground is subtracted; then medians of that without the blobs.
  std::fill(ground_.begin(), ground_.end(), 0.0F);
  blocks_.clear();
  const double beyond = bright ? 1 - kBeyond : kBeyond;
  for (const Pass& pass :
       {Pass{beyond, false}, Pass{beyond, false}, Pass{0.5, true}, Pass{0.5, true}}) {
    correctBlocks(picture, bright, pass.quantile, pass.masked);
    interpolate();
  }
  standOut(picture, bright);
}

/// The noise of pixels from the curvature of the grey values along rows, which light and blobs
/// hardly change in most places.
void BlobGround::measureNoise(const optics::GreyView& picture) {
  noise_ = 1;
  constexpr int kSampledRow = 7;
  constexpr int kEveryColumn = 3;
  constexpr std::size_t kFewest = 100;
  constexpr int kRounds = 5;
  constexpr double kTrimmed = 9;           // [1] squares over their mean
  constexpr double kTrimmedMean = 0.9733;  // of chi^2 of one degree of freedom below that
  std::vector<double> squares;
  for (int y = 0; y < height_; y += kSampledRow) {
    const ColumnSpan& span = columns_[static_cast<std::size_t>(y)];
    const std::uint8_t* grey = picture.row(y);
    for (int x = span.first + 1; x < span.last; x += kEveryColumn) {
      const double bend = 2.0 * grey[x] - grey[x - 1] - grey[x + 1];
      squares.push_back(bend * bend / (6 * variance(grey[x])));
    }
  }
  if (squares.size() >= kFewest) {
    // The mean of what is not an edge: medians would be those of whole grey values.
    std::vector<double> copy = squares;
    double mean = std::max(0.1, medianOf(copy) / kMedianSquare);
    for (int round = 0; round < kRounds; ++round) {
      double sum = 0;
      int count = 0;
      for (const double square : squares) {
        if (square > kTrimmed * mean) continue;
        sum += square;
        ++count;
      }
      mean = sum / std::max(count, 1) / kTrimmedMean;
    }
    noise_ = std::clamp(mean, 0.1, 100.0);
  }
  if (imaging_.compressed) noise_ = std::max(noise_, 1.0) * kLossyErrors;
}

/// Adds to each block a quantile of the differences between picture and ground.
void BlobGround::correctBlocks(const optics::GreyView& picture, bool bright, double quantile,
                               bool masked) {
  const int across = (width_ + block_ - 1) / block_;
  const int down = (height_ + block_ - 1) / block_;
  const auto count = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  const bool first = blocks_.empty();
  const float zero = first ? 0 : kGreys / 2.0F;  // bin of no difference
  blocks_.resize(count, 0);
  histograms_.assign(count * kGreys, 0);
  const float sign = bright ? 1 : -1;
  std::array<float, kGreys> limits{};
  for (std::size_t grey = 0; grey < kGreys; ++grey) {
    const auto light = static_cast<float>(grey);
    limits[grey] =
        std::max(threshold(light),
                 static_cast<float>(kClear * std::sqrt(variance(static_cast<double>(light)))));
  }
  for (int y = 0; y < height_; y += kEveryRow) {
    const ColumnSpan& span = columns_[static_cast<std::size_t>(y)];
    const std::uint8_t* grey = picture.row(y);
    const float* ground = row(y);
    int* line = &histograms_[static_cast<std::size_t>(y / block_ * across) * kGreys];
    for (int x = span.first; x <= span.last; ++x) {
      const float off = static_cast<float>(grey[x]) - ground[x];
      if (masked) {
        const auto here = static_cast<std::size_t>(std::clamp(ground[x], 0.0F, kGreys - 1.0F));
        if (sign * off > limits[here]) continue;
      }
      const float bin = std::clamp(off + zero + 0.5F, 0.0F, kGreys - 0.5F);
      ++line[static_cast<std::size_t>(x / block_) * kGreys + static_cast<std::size_t>(bin)];
    }
  }
  // Where a block has too few pixels, its neighbours count too.
  std::vector<float> corrections(count);
  std::array<int, kGreys> sum{};
  for (int j = 0; j < down; ++j) {
    for (int i = 0; i < across; ++i) {
      int pixels = 0;
      for (int reach = 0;
           pixels < block_ * block_ / (4 * kEveryRow) && reach <= std::max(across, down); ++reach) {
        sum.fill(0);
        for (int v = std::max(0, j - reach); v <= std::min(down - 1, j + reach); ++v) {
          for (int u = std::max(0, i - reach); u <= std::min(across - 1, i + reach); ++u) {
            const int* part = &histograms_[static_cast<std::size_t>(v * across + u) * kGreys];
            for (std::size_t grey = 0; grey < kGreys; ++grey) sum[grey] += part[grey];
          }
        }
        pixels = pixelsIn(sum.data());
      }
      corrections[static_cast<std::size_t>(j * across + i)] =
          greyAt(sum.data(), quantile, pixels) - zero;
    }
  }
  for (std::size_t i = 0; i < count; ++i) blocks_[i] += corrections[i];
}

void BlobGround::interpolate() {
  const int across = (width_ + block_ - 1) / block_;
  const int down = (height_ + block_ - 1) / block_;
  struct Between {
    std::size_t low;
    float share;
  };
  // Beyond the outermost centres the ground is extrapolated.
  const auto between = [this](int pixel, int count) -> Between {
    if (count < 2) return {0, 0};
    const float place = (static_cast<float>(pixel) + 0.5F) / static_cast<float>(block_) - 0.5F;
    const int low = std::clamp(static_cast<int>(std::floor(place)), 0, count - 2);
    return {static_cast<std::size_t>(low), place - static_cast<float>(low)};
  };
  std::vector<Between> columns;
  for (int x = 0; x < width_; ++x) columns.push_back(between(x, across));
  const std::size_t right = across > 1 ? 1 : 0;
  std::vector<float> line(static_cast<std::size_t>(across));
  for (int y = 0; y < height_; ++y) {
    const Between rows = between(y, down);
    for (std::size_t i = 0; i < line.size(); ++i) {
      const float upper = blocks_[rows.low * line.size() + i];
      const float lower = blocks_[(rows.low + (down > 1 ? 1 : 0)) * line.size() + i];
      line[i] = upper + rows.share * (lower - upper);
    }
    float* out = &ground_[at(y)];
    for (int x = 0; x < width_; ++x) {
      const Between& c = columns[static_cast<std::size_t>(x)];
      out[x] = line[c.low] + c.share * (line[c.low + right] - line[c.low]);
    }
  }
}

void BlobGround::standOut(const optics::GreyView& picture, bool bright) {
  const auto width = static_cast<std::size_t>(width_);
  const float sign = bright ? 1 : -1;
  rows_.assign(3 * width, 0);
  const auto difference = [&](int y) {
    float* out = &rows_[static_cast<std::size_t>(y % 3) * width];
    std::fill(out, out + width, 0.0F);
    if (y < 0 || y >= height_) return;
    const ColumnSpan& span = columns_[static_cast<std::size_t>(y)];
    const std::uint8_t* grey = picture.row(y);
    const float* ground = row(y);
    for (int x = span.first; x <= span.last; ++x) {
      out[x] = sign * (static_cast<float>(grey[x]) - ground[x]);
    }
  };
  difference(0);
  for (int y = 0; y < height_; ++y) {
    if (y + 1 < height_) {
      difference(y + 1);
    } else {
      std::fill_n(&rows_[static_cast<std::size_t>((y + 1) % 3) * width], width, 0.0F);
    }
    float* out = &contrast_[at(y)];
    std::fill(out, out + width, 0.0F);
    const ColumnSpan& span = columns_[static_cast<std::size_t>(y)];
    const float* a = rows_.data();
    const float* b = a + width;
    const float* c = b + width;
    for (int x = std::max(1, span.first); x <= std::min(width_ - 2, span.last); ++x) {
      out[x] =
          (a[x - 1] + a[x] + a[x + 1] + b[x - 1] + b[x] + b[x + 1] + c[x - 1] + c[x] + c[x + 1]) /
          9;
    }
  }
}

}  // namespace lab::detector
