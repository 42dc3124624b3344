#include "light/field/raster.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "light/field/image.hpp"

namespace lab::light {

PictureSize pictureSize(double width, double height, int nx) {
  const auto pixels = [](double count) {
    return std::max(1, static_cast<int>(std::lround(count)));
  };
  const int most = 2 * nx;
  const double ny = nx * height / width;
  if (ny <= most) return {nx, pixels(ny)};
  return {pixels(most * width / height), most};
}

Raster rasterise(const CompiledField& field, double width, double height, int nx, int ny) {
  if (nx < 1 || ny < 1 || !(width > 0) || !(height > 0)) {
    throw std::invalid_argument("rasterise: needs at least one pixel and a size above 0");
  }
  const auto columns = static_cast<std::size_t>(nx);
  const auto rows = static_cast<std::size_t>(ny);
  Raster raster{nx, ny, std::vector<float>(columns * rows)};
  const double step_x = width / nx;
  const double step_y = height / ny;
  std::vector<double> row(columns);
  for (std::size_t j = 0; j < rows; ++j) {
    const double y = (static_cast<double>(j) + 0.5) * step_y;
    field.evaluateRow(0.5 * step_x, step_x, y, columns, row.data());
    float* out = raster.values.data() + j * columns;
    for (std::size_t i = 0; i < columns; ++i) out[i] = static_cast<float>(row[i]);
  }
  return raster;
}

Raster rasterise(const Field& field, double width, double height, int nx, int ny) {
  return rasterise(CompiledField(field), width, height, nx, ny);
}

std::vector<std::uint8_t> toGrey(const Raster& raster) {
  std::vector<std::uint8_t> grey;
  grey.reserve(raster.values.size());
  for (int j = raster.ny - 1; j >= 0; --j) {
    for (int i = 0; i < raster.nx; ++i) {
      grey.push_back(static_cast<std::uint8_t>(std::lround(255 * raster.at(i, j))));
    }
  }
  return grey;
}

std::vector<std::uint8_t> toPng(const Raster& raster) {
  return encodePng(raster.nx, raster.ny, toGrey(raster));
}

FramePainter::FramePainter(double width, double height, int nx, int ny)
    : width_(width), height_(height) {
  layers_.raster = rasterise(Field{}, width, height, nx, ny);
  previous_.raster = layers_.raster;
  mixed_ = layers_.raster;
}

void FramePainter::refresh(End& end, const std::vector<Layer>& layers) {
  if (end.layers == layers) return;
  end.raster = rasterise(Field{layers, {}, 1}, width_, height_, end.raster.nx, end.raster.ny);
  end.layers = layers;
}

const Raster& FramePainter::paint(const Field& field) {
  // A new ramp starts where the last one ended, which is already painted.
  if (isMoving(field) && field.previous == layers_.layers) std::swap(layers_, previous_);
  refresh(layers_, field.layers);
  if (!isMoving(field)) return layers_.raster;
  refresh(previous_, field.previous);
  const auto mix = static_cast<float>(field.mix);
  for (std::size_t i = 0; i < mixed_.values.size(); ++i) {
    const float from = previous_.raster.values[i];
    mixed_.values[i] = from + mix * (layers_.raster.values[i] - from);
  }
  return mixed_;
}

}  // namespace lab::light
