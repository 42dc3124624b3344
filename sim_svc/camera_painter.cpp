#include "sim_svc/camera_painter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/math/random.hpp"
#include "sim_svc/camera/camera_painter_cells.hpp"
#include "sim_svc/camera/camera_painter_ground.hpp"
#include "sim_svc/camera/camera_painter_light.hpp"
#include "sim_svc/camera/camera_painter_noise.hpp"
#include "sim_svc/camera/camera_painter_robot.hpp"
#include "sim_svc/camera/camera_painter_warp.hpp"

namespace lab::sim {
namespace {

using painter::Box;
using painter::Lattice;

constexpr double kLongestPiece = 1;  // [px] largest motion in a piece of the exposure

LAB_TARGET_CLONES
void reflect(const float* __restrict albedo, float ambient, float* __restrict grey, int count) {
  for (int i = 0; i < count; ++i) grey[i] = albedo[i] * (ambient + grey[i]);
}

LAB_TARGET_CLONES
void blend(const float* __restrict before, const float* __restrict after, float mix,
           float* __restrict out, int count) {
  for (int i = 0; i < count; ++i) out[i] = before[i] + mix * (after[i] - before[i]);
}

LAB_TARGET_CLONES
void develop(const float* __restrict blurred, const float* __restrict gain,
             const float* __restrict offset, float* __restrict mean, int count) {
  for (int i = 0; i < count; ++i) mean[i] = offset[i] + gain[i] * blurred[i];
}

}  // namespace

class CameraPainter::Parts {
 public:
  explicit Parts(PainterSettings the_settings);

  void setLight(const light::Field& field);
  void expose(std::span<const PaintedRobot> robots);

  PainterSettings settings;
  std::vector<float> mean;  ///< [DN] of the last exposure
  painter::SensorNoise noise;

 private:
  /// The empty arena lit by one list of layers.
  struct Shown {
    std::vector<light::Layer> layers;
    painter::Projection projection;
    std::vector<float> grey;  ///< [1] light from the cells of the empty arena
    std::vector<float> mean;  ///< [DN] pixels of the empty arena
  };

  void makePixels();
  void show(Shown& shown, const std::vector<light::Layer>& layers);
  void uncover(const Box& cells);
  void lightCaps(const Box& pixels);
  [[nodiscard]] painter::LitPlaces places(const std::optional<painter::WarpedPlaces>& bent,
                                          const painter::PlaneShift& shift) const;
  void paintPiece(std::span<const PaintedRobot> robots, double duration);
  [[nodiscard]] int pieces(std::span<const PaintedRobot> robots) const;
  void clear();

  optics::CameraModel model_;
  painter::PointSpread spread_;
  Lattice lattice_;
  painter::Ground ground_;
  painter::PlaneShift to_projector_;
  painter::PlaneShift to_camera_;
  std::optional<painter::WarpedPlaces> warped_ground_;  ///< empty: the projector is exact
  std::optional<painter::WarpedPlaces> warped_caps_;
  std::vector<float> gain_;    ///< [DN] per pixel, of a surface of albedo 1 in full light
  std::vector<float> offset_;  ///< [DN] per pixel, in the dark
  std::array<Shown, 2> shown_;
  std::size_t now_ = 0;  ///< index of the present one; the other is the previous one
  double mix_ = 1;
  bool stale_ = true;         ///< `mean` does not show the present light
  std::vector<Box> painted_;  ///< [px] where `mean` differs from the empty arena
  std::vector<float> cap_light_, cap_light_before_, grey_;  ///< [1] per cell
  std::vector<float> blurred_;                              ///< [1] per pixel
};

CameraPainter::Parts::Parts(PainterSettings the_settings)
    : settings(std::move(the_settings)),
      noise(settings.seed, optics::CameraResponse(settings.imaging)),
      model_(settings.camera),
      spread_(settings.imaging.blur),
      lattice_{settings.camera.width, settings.camera.height, spread_.reach() + 1},
      ground_(settings, lattice_, model_),
      to_projector_(
          painter::PlaneShift::towards(settings.projector, settings.cap.height, settings.sheet)),
      to_camera_(
          painter::PlaneShift::towards(model_.centre(), settings.cap.height, settings.sheet)),
      cap_light_(lattice_.size()),
      cap_light_before_(lattice_.size()),
      grey_(lattice_.size()) {
  makePixels();
  if (!settings.warp.isIdentity()) {
    warped_ground_.emplace(settings, lattice_, ground_, to_projector_);
    warped_caps_.emplace(settings, lattice_, ground_, to_camera_);
  }
  mean.resize(gain_.size());
  blurred_.resize(gain_.size());
  show(shown_[0], {});
}

void CameraPainter::Parts::makePixels() {
  const int width = lattice_.width;
  const int height = lattice_.height;
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const double exposed = settings.exposure / kFullExposure * settings.gain;
  const double full = kFullSignal / settings.albedos.floor * exposed;
  Random random(deriveSeed(settings.seed, 0, "pixels"));
  gain_.resize(count);
  offset_.assign(count, static_cast<float>(settings.imaging.black));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double across = 2.0 * x / (width - 1) - 1;
      const double down = 2.0 * y / (height - 1) - 1;
      const double lost = settings.vignetting * 0.5 * (across * across + down * down);
      const double pixel = 1 + settings.unevenness * random.normal();
      gain_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(x)] = static_cast<float>(full * (1 - lost) * pixel);
    }
  }
  for (int i = 0; i < settings.hot_pixels; ++i) {
    offset_[random.next() % count] += static_cast<float>((40 + 200 * random.uniform()) * exposed);
  }
  for (const GlareSpot& glare : settings.glares) {
    optics::PlaneScale scale;
    const optics::Pixel at = model_.project(glare.x, glare.y, settings.cap.height, scale);
    const double sigma =
        glare.sigma * std::sqrt(std::abs(scale.ux * scale.vy - scale.uy * scale.vx));
    const Box box =
        painter::pixelsAround(model_, glare.x, glare.y, settings.cap.height, 4.5 * glare.sigma)
            .within(lattice_.picture());
    for (int y = box.y0; y < box.y1; ++y) {
      for (int x = box.x0; x < box.x1; ++x) {
        const double d2 = (x - at.x) * (x - at.x) + (y - at.y) * (y - at.y);
        offset_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x)] +=
            static_cast<float>(kFullSignal * exposed * glare.strength *
                               std::exp(-0.5 * d2 / (sigma * sigma)));
      }
    }
  }
}

void CameraPainter::Parts::show(Shown& shown, const std::vector<light::Layer>& layers) {
  const painter::LitPlaces lit = places(warped_ground_, to_projector_);
  painter::Projection projection(
      layers, settings,
      painter::cellSize(model_, settings.arena_width / 2, settings.arena_height / 2));
  const bool first = shown.mean.empty();
  shown.grey.resize(lattice_.size());
  shown.mean.resize(gain_.size());
  const Box whole{0, 0, lattice_.columns() / 2, lattice_.rows() / 2};
  const std::vector<Box> boxes =
      first ? std::vector{whole} : projection.changed(shown.projection, lattice_, lit);
  shown.layers = layers;
  shown.projection = std::move(projection);
  // Light all cells first, because a pixel also depends on the cells around it.
  for (const Box& box : boxes) {
    const Box cells{2 * box.x0, 2 * box.y0, 2 * box.x1, 2 * box.y1};
    shown.projection.light(lattice_, lit, cells, shown.grey);
    for (int j = cells.y0; j < cells.y1; ++j) {
      const std::size_t at = lattice_.at(cells.x0, j);
      reflect(&ground_.albedo[at], static_cast<float>(settings.ambient), &shown.grey[at],
              cells.width());
    }
  }
  for (const Box& box : boxes) {
    const int margin = lattice_.margin;
    const Box seen = Box{box.x0 - margin, box.y0 - margin, box.x1 - margin, box.y1 - margin}
                         .grown(spread_.reach())
                         .within(lattice_.picture());
    spread_.apply(lattice_, shown.grey.data(), seen, blurred_.data());
    for (int y = seen.y0; y < seen.y1; ++y) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(lattice_.width) +
          static_cast<std::size_t>(seen.x0);
      develop(&blurred_[at], &gain_[at], &offset_[at], &shown.mean[at], seen.width());
    }
  }
}

void CameraPainter::Parts::setLight(const light::Field& field) {
  const bool moving = light::isMoving(field);
  const auto holds = [&](std::size_t i, const std::vector<light::Layer>& layers) {
    return !shown_[i].mean.empty() && shown_[i].layers == layers;
  };
  const std::size_t was = now_;
  if (holds(1 - now_, field.layers)) {
    now_ = 1 - now_;
  } else if (!holds(now_, field.layers)) {
    // The present light may be the start of a transition.
    now_ = 1 - now_;
    if (moving && holds(now_, field.previous)) now_ = 1 - now_;
    show(shown_[now_], field.layers);
    stale_ = true;
  }
  if (moving && !holds(1 - now_, field.previous)) {
    show(shown_[1 - now_], field.previous);
    stale_ = true;
  }
  const double mix = moving ? std::max(field.mix, 0.0) : 1.0;
  stale_ = stale_ || now_ != was || mix != mix_;
  mix_ = mix;
}

/// Resets `mean` to the empty arena.
void CameraPainter::Parts::clear() {
  const Shown& after = shown_[now_];
  const Shown& before = shown_[1 - now_];
  const auto restore = [&](std::size_t at, int count) {
    if (mix_ < 1) {
      blend(&before.mean[at], &after.mean[at], static_cast<float>(mix_), &mean[at], count);
    } else {
      std::copy_n(&after.mean[at], count, &mean[at]);
    }
  };
  if (stale_) {
    restore(0, static_cast<int>(mean.size()));
  } else {
    for (const Box& box : painted_) {
      for (int y = box.y0; y < box.y1; ++y) {
        restore(static_cast<std::size_t>(y) * static_cast<std::size_t>(lattice_.width) +
                    static_cast<std::size_t>(box.x0),
                box.width());
      }
    }
  }
  painted_.clear();
  stale_ = false;
}

painter::LitPlaces CameraPainter::Parts::places(const std::optional<painter::WarpedPlaces>& bent,
                                                const painter::PlaneShift& shift) const {
  return bent ? bent->view() : painter::LitPlaces{ground_.x.data(), ground_.y.data(), shift};
}

/// Computes the light at cap height in these pixels.
void CameraPainter::Parts::lightCaps(const Box& pixels) {
  // One pixel more, because pixels at the border are computed by the slow method.
  const Box cells = lattice_.cells(pixels.grown(1)).within(lattice_.all());
  const painter::LitPlaces lit = places(warped_caps_, to_camera_);
  shown_[now_].projection.light(lattice_, lit, cells, cap_light_);
  if (mix_ >= 1) return;
  shown_[1 - now_].projection.light(lattice_, lit, cells, cap_light_before_);
  for (int j = cells.y0; j < cells.y1; ++j) {
    for (int i = cells.x0; i < cells.x1; ++i) {
      float& light = cap_light_[lattice_.at(i, j)];
      const float before = cap_light_before_[lattice_.at(i, j)];
      light = before + static_cast<float>(mix_) * (light - before);
    }
  }
}

/// Resets these cells to the empty arena.
void CameraPainter::Parts::uncover(const Box& cells) {
  const Shown& after = shown_[now_];
  const Shown& before = shown_[1 - now_];
  for (int j = cells.y0; j < cells.y1; ++j) {
    const std::size_t at = lattice_.at(cells.x0, j);
    if (mix_ < 1) {
      blend(&before.grey[at], &after.grey[at], static_cast<float>(mix_), &grey_[at], cells.width());
    } else {
      std::copy_n(&after.grey[at], cells.width(), &grey_[at]);
    }
  }
}

/// Paints robots that move for `duration` into `mean`.
void CameraPainter::Parts::paintPiece(std::span<const PaintedRobot> robots, double duration) {
  std::vector<painter::RobotPainter> painters;
  const int reach = spread_.reach();
  for (const PaintedRobot& robot : robots) {
    painter::RobotPainter one(settings, model_, robot, duration);
    const Box seen = one.pixels().grown(reach).within(lattice_.picture());
    if (seen.empty()) continue;
    painters.push_back(one);
    painted_.push_back(seen);
    uncover(lattice_.cells(seen.grown(reach)).within(lattice_.all()));
    lightCaps(one.pixels());
  }
  const painter::Canvas canvas{&lattice_, &ground_, cap_light_.data(), grey_.data()};
  for (const auto& one : painters) one.castShadow(canvas);
  for (const auto& one : painters) one.paintSides(canvas);
  for (const auto& one : painters) one.paintTop(canvas);
  for (const Box& seen : painted_) {
    spread_.apply(lattice_, grey_.data(), seen, blurred_.data());
    for (int y = seen.y0; y < seen.y1; ++y) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(lattice_.width) +
          static_cast<std::size_t>(seen.x0);
      develop(&blurred_[at], &gain_[at], &offset_[at], &mean[at], seen.width());
    }
  }
}

int CameraPainter::Parts::pieces(std::span<const PaintedRobot> robots) const {
  double longest = 0;
  for (const PaintedRobot& robot : robots) {
    const double speed =
        std::hypot(robot.vx, robot.vy) + std::abs(robot.omega) * settings.cap.robot_radius;
    const optics::PlaneScale scale = model_.scaleAt({robot.x, robot.y}, settings.cap.height);
    longest = std::max(longest, speed * std::hypot(scale.ux, scale.uy));
  }
  return std::max(1, static_cast<int>(std::ceil(longest * settings.exposure / kLongestPiece)));
}

void CameraPainter::Parts::expose(std::span<const PaintedRobot> robots) {
  if (settings.sheet > 0) robots = {};
  const int count = pieces(robots);
  const double duration = settings.exposure / count;
  std::vector<PaintedRobot> moved(robots.begin(), robots.end());
  std::vector<float> sum;
  for (int piece = 0; piece < count; ++piece) {
    const double later = (piece + 0.5) * duration - 0.5 * settings.exposure;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      moved[i].x = robots[i].x + robots[i].vx * later;
      moved[i].y = robots[i].y + robots[i].vy * later;
      moved[i].theta = robots[i].theta + robots[i].omega * later;
    }
    clear();
    paintPiece(moved, duration);
    if (count == 1) return;
    sum.resize(mean.size(), 0.0F);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += mean[i];
  }
  for (std::size_t i = 0; i < sum.size(); ++i) mean[i] = sum[i] / static_cast<float>(count);
  stale_ = true;
}

CameraPainter::CameraPainter(PainterSettings settings)
    : parts_(std::make_unique<Parts>(std::move(settings))) {}

CameraPainter::~CameraPainter() = default;

const PainterSettings& CameraPainter::settings() const { return parts_->settings; }

void CameraPainter::setLight(const light::Field& field) { parts_->setLight(field); }

void CameraPainter::paint(std::span<const PaintedRobot> robots, std::int64_t number,
                          std::span<std::uint8_t> out) {
  if (out.size() != parts_->mean.size()) {
    throw std::invalid_argument(fmt::format("a buffer of {} bytes for a picture of {} bytes",
                                            out.size(), parts_->mean.size()));
  }
  parts_->expose(robots);
  const PainterSettings& settings = parts_->settings;
  parts_->noise.finish(parts_->mean, settings.camera.width,
                       pixelNoise(settings.imaging, settings.gain), settings.imaging.black, number,
                       out);
}

std::vector<float> CameraPainter::expose(std::span<const PaintedRobot> robots) {
  parts_->expose(robots);
  return parts_->mean;
}

}  // namespace lab::sim
