#include "projector_ctl/painter/screen_painter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "light/field/target_clones.hpp"

namespace lab::projector {

namespace {

constexpr int kBlockTiles = 4;  // tiles per side of a block
constexpr double kNoPlace = std::numeric_limits<double>::quiet_NaN();

/// Equals lround(255 * float(value)), in a form that can be vectorised.
LAB_TARGET_CLONES
void toBytes(const double* intensity, std::size_t count, std::uint8_t* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float level = 255 * static_cast<float>(intensity[i]);
    out[i] = static_cast<std::uint8_t>(static_cast<int>(static_cast<double>(level) + 0.5));
  }
}

}  // namespace

void Tone::apply(const double* intensity, int /*x*/, int /*y*/, std::size_t count,
                 std::uint8_t* out) const {
  toBytes(intensity, count, out);
}

ScreenPainter::ScreenPainter(const optics::ProjectorModel& model, std::shared_ptr<const Tone> tone)
    : tone_(tone ? std::move(tone) : std::make_shared<const Tone>()),
      picture_(model.columns(), model.rows()),
      straight_(model.isNominal()),
      tile_x_(kTile * kTile),
      tile_y_(kTile * kTile),
      tile_light_(kTile * kTile) {
  mapPlaces(model);
  constexpr int kSide = kTile * kBlockTiles;
  for (int top = 0; top < picture_.height; top += kSide) {
    for (int left = 0; left < picture_.width; left += kSide) {
      Block& block = blocks_.emplace_back();
      for (int y = top; y < std::min(top + kSide, picture_.height); y += kTile) {
        for (int x = left; x < std::min(left + kSide, picture_.width); x += kTile) {
          block.tiles.push_back(tileAt(
              {x, y, std::min(kTile, picture_.width - x), std::min(kTile, picture_.height - y)}));
        }
      }
      block.disk = around(block.tiles);
    }
  }
}

void ScreenPainter::mapPlaces(const optics::ProjectorModel& model) {
  const auto columns = static_cast<std::size_t>(picture_.width);
  const auto rows = static_cast<std::size_t>(picture_.height);
  if (straight_) {
    x_.resize(columns);
    y_.resize(rows);
    for (std::size_t i = 0; i < columns; ++i) {
      x_[i] = model.placeOf({static_cast<double>(i), 0}).value().x;
    }
    for (std::size_t j = 0; j < rows; ++j) {
      y_[j] = model.placeOf({0, static_cast<double>(j)}).value().y;
    }
    return;
  }
  x_.resize(columns * rows);
  y_.resize(columns * rows);
  for (std::size_t j = 0; j < rows; ++j) {
    for (std::size_t i = 0; i < columns; ++i) {
      const auto place = model.placeOf({static_cast<double>(i), static_cast<double>(j)});
      x_[j * columns + i] = place ? place->x : kNoPlace;
      y_[j * columns + i] = place ? place->y : kNoPlace;
    }
  }
}

/// Writes the positions of a tile's pixels, row by row, to tile_x_ and tile_y_.
void ScreenPainter::placesOf(const Tile& tile) {
  const Box& box = tile.box;
  const auto width = static_cast<std::size_t>(box.width);
  for (int j = 0; j < box.height; ++j) {
    double* const x = tile_x_.data() + static_cast<std::size_t>(j) * width;
    double* const y = tile_y_.data() + static_cast<std::size_t>(j) * width;
    const auto row = static_cast<std::size_t>(box.y + j);
    const auto column = static_cast<std::size_t>(box.x);
    if (straight_) {
      std::copy_n(&x_[column], width, x);
      std::fill_n(y, width, y_[row]);
    } else {
      const std::size_t at = row * static_cast<std::size_t>(picture_.width) + column;
      std::copy_n(&x_[at], width, x);
      std::copy_n(&y_[at], width, y);
    }
  }
}

ScreenPainter::Tile ScreenPainter::tileAt(const Box& box) {
  Tile tile;
  tile.box = box;
  placesOf(tile);
  const auto count = static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height);
  double left = std::numeric_limits<double>::infinity();
  double right = -left;
  double bottom = left;
  double top = -left;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(tile_x_[i])) {
      tile.gaps = true;
      continue;
    }
    tile.lit = true;
    left = std::min(left, tile_x_[i]);
    right = std::max(right, tile_x_[i]);
    bottom = std::min(bottom, tile_y_[i]);
    top = std::max(top, tile_y_[i]);
  }
  if (!tile.lit) return tile;
  tile.disk = {0.5 * (left + right), 0.5 * (bottom + top), 0};
  for (std::size_t i = 0; i < count; ++i) {
    const double away = std::hypot(tile_x_[i] - tile.disk.x, tile_y_[i] - tile.disk.y);
    if (away > tile.disk.radius) tile.disk.radius = away;  // false for NaN
  }
  return tile;
}

light::Disk ScreenPainter::around(const std::vector<Tile>& tiles) {
  light::Disk disk;
  double lit = 0;
  for (const Tile& tile : tiles) {
    if (!tile.lit) continue;
    disk.x += tile.disk.x;
    disk.y += tile.disk.y;
    ++lit;
  }
  if (lit == 0) return disk;
  disk.x /= lit;
  disk.y /= lit;
  for (const Tile& tile : tiles) {
    if (!tile.lit) continue;
    const double away = std::hypot(tile.disk.x - disk.x, tile.disk.y - disk.y);
    disk.radius = std::max(disk.radius, away + tile.disk.radius);
  }
  return disk;
}

std::span<const Box> ScreenPainter::paint(const light::Field& field) {
  changed_.clear();
  const light::CompiledField all(field);
  for (Block& block : blocks_) {
    const light::CompiledField near = all.within(block.disk);
    for (Tile& tile : block.tiles) {
      light::CompiledField here = tile.lit ? near.within(tile.disk) : light::CompiledField();
      if (tile.painted && here == tile.shown) continue;
      tile.shown = std::move(here);
      tile.painted = true;
      paint(tile);
      noteChanged(tile.box);
    }
  }
  return changed_;
}

/// Adds a changed tile; adjacent tiles are merged into one box.
void ScreenPainter::noteChanged(const Box& box) {
  if (!changed_.empty()) {
    Box& last = changed_.back();
    if (last.y == box.y && last.height == box.height && last.x + last.width == box.x) {
      last.width += box.width;
      return;
    }
  }
  changed_.push_back(box);
}

void ScreenPainter::paint(Tile& tile) {
  const Box& box = tile.box;
  const auto width = static_cast<std::size_t>(box.width);
  const std::size_t count = width * static_cast<std::size_t>(box.height);
  const bool constant = !tile.gaps && tile.shown.isUniform();
  if (constant && tone_->isSameEverywhere()) {
    const double value = tile.shown.evaluate(tile.disk.x, tile.disk.y);
    std::uint8_t level = 0;
    tone_->apply(&value, box.x, box.y, 1, &level);
    for (int j = 0; j < box.height; ++j) std::fill_n(picture_.row(box.y + j) + box.x, width, level);
    return;
  }
  placesOf(tile);
  tile.shown.evaluateAt(tile_x_.data(), tile_y_.data(), count, tile_light_.data());
  if (tile.gaps) {
    for (std::size_t i = 0; i < count; ++i) {
      if (std::isnan(tile_x_[i])) tile_light_[i] = 0;
    }
  }
  for (int j = 0; j < box.height; ++j) {
    tone_->apply(tile_light_.data() + static_cast<std::size_t>(j) * width, box.x, box.y + j, width,
                 picture_.row(box.y + j) + box.x);
  }
}

void ScreenPainter::forget(const Box& box) {
  for (Block& block : blocks_) {
    for (Tile& tile : block.tiles) {
      if (tile.box.touches(box)) tile.painted = false;
    }
  }
}

}  // namespace lab::projector
