#include "tracker_svc/detector/sync_reader.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace lab::tracker {
namespace {

constexpr double kReach = 0.06;  // [m] around the corner in which the patch is searched
constexpr double kSettle = 0.1;  // [s] after a change, until a picture shows only the new state
constexpr int kLeastTurns = 2;
constexpr int kMostTurns = 16;  // more do not improve the contrast
constexpr float kTop = 0.99F;   // quantile: the patch covers more than a hundredth of the window
constexpr float kLeastContrast = 4;  // [DN]
constexpr float kNoiseTimes = 6;     // times the usual difference between two pictures
constexpr double kRemember = 0.2;    // [1] weight of the newest picture in dark_ and bright_
constexpr double kBright = 0.6;      // [1] of the level; in between the state is undefined
constexpr double kDark = 0.4;

}  // namespace

SyncReader::SyncReader(const optics::CameraModel& camera) {
  double least_x = 1e9, least_y = 1e9, most_x = -1e9, most_y = -1e9;
  for (const double x : {-kReach, kReach}) {
    for (const double y : {-kReach, kReach}) {
      const optics::Pixel at = camera.project(x, y, 0);
      least_x = std::min(least_x, at.x);
      least_y = std::min(least_y, at.y);
      most_x = std::max(most_x, at.x);
      most_y = std::max(most_y, at.y);
    }
  }
  const optics::CameraParameters& picture = camera.parameters();
  const auto within = [](double value, int most) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most)));
  };
  left_ = within(std::ceil(least_x), picture.width);
  top_ = within(std::ceil(least_y), picture.height);
  columns_ = within(std::floor(most_x) + 1, picture.width) - left_;
  rows_ = within(std::floor(most_y) + 1, picture.height) - top_;
  difference_.assign(static_cast<std::size_t>(std::max(columns_, 0) * std::max(rows_, 0)), 0.0F);
}

void SyncReader::reportChange(double time, int sync, std::int64_t command, bool still) {
  if (sync == turn_.sync && command == turn_.command) return;
  turn_ = {time, sync, command, still && turn_.sync >= 0 && command == turn_.command};
  settled_ = false;
}

void SyncReader::copyWindow(const optics::GreyView& picture) {
  now_.resize(difference_.size());
  auto out = now_.begin();
  for (int row = top_; row < top_ + rows_; ++row) {
    const std::uint8_t* from = picture.row(row) + left_;
    out = std::copy(from, from + columns_, out);
  }
}

std::optional<SyncReading> SyncReader::look(const optics::GreyView& picture, double time) {
  if (difference_.empty() || turn_.sync < 0) return std::nullopt;
  copyWindow(picture);
  const bool is_settled = time > turn_.time + kSettle;
  if (is_settled && !settled_) {
    settled_ = true;
    if (turn_.alone && has_before_ && turns_ < kMostTurns) learn();
  }
  // A picture taken after a change that is not known yet would spoil the means. The projector
  // reports a change before the camera can have delivered such a picture.
  if (is_settled) {
    before_ = now_;
    has_before_ = true;
  }
  if (weights_.empty()) return std::nullopt;
  const double value = signal();
  if (is_settled) {
    double& reference = turn_.sync == 1 ? bright_ : dark_;
    int& known = turn_.sync == 1 ? known_bright_ : known_dark_;
    reference += (known == 0 ? 1 : kRemember) * (value - reference);
    ++known;
  }
  if (known_dark_ == 0 || known_bright_ == 0 || bright_ <= dark_) return std::nullopt;
  const double level = (value - dark_) / (bright_ - dark_);
  const std::int8_t sync = level > kBright ? 1 : level < kDark ? 0 : -1;
  return SyncReading{static_cast<float>(level), sync};
}

void SyncReader::learn() {
  const float sign = turn_.sync == 1 ? 1.0F : -1.0F;
  for (std::size_t i = 0; i < now_.size(); ++i) difference_[i] += sign * (now_[i] - before_[i]);
  ++turns_;
  if (turns_ >= kLeastTurns) chooseWeights();
}

void SyncReader::chooseWeights() {
  std::vector<float> sorted = difference_;
  // Not percentilesOf(): the lower rank of each quantile, of floats, without sorting a window.
  const auto at = [&](float share) {
    const auto place =
        sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<float>(sorted.size() - 1));
    std::nth_element(sorted.begin(), place, sorted.end());
    return *place;
  };
  const float middle = at(0.5F);
  const float top = at(kTop) - middle;  // subtracts a change of the whole window
  for (float& value : sorted) value = std::abs(value - middle);
  const float usual = at(0.5F);
  const auto turns = static_cast<float>(turns_);
  if (top < kLeastContrast * turns || top < kNoiseTimes * usual) {
    weights_.clear();
    return;
  }
  const bool first = weights_.empty();
  weights_.resize(difference_.size());
  for (std::size_t i = 0; i < difference_.size(); ++i) {
    const float more = difference_[i] - middle;
    weights_[i] = more > top / 2 ? more / turns : 0.0F;
  }
  if (!first) return;
  known_dark_ = known_bright_ = 0;
}

double SyncReader::signal() const {
  double sum = 0;
  double weights = 0;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    sum += static_cast<double>(weights_[i] * now_[i]);
    weights += static_cast<double>(weights_[i]);
  }
  return sum / weights;
}

}  // namespace lab::tracker
