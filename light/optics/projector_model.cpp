#include "light/optics/projector_model.hpp"

namespace lab::optics {

ProjectorModel::ProjectorModel(double width, double height, int columns, int rows)
    : width_(width), height_(height), columns_(columns), rows_(rows) {}

ProjectorModel::ProjectorModel(const CameraParameters& lens, double height)
    : lens_(lens), sensor_height_(height), columns_(lens.width), rows_(lens.height) {}

Pixel ProjectorModel::pixelOf(Place place) const {
  if (lens_) return lens_->project(place.x, place.y, sensor_height_);
  return {place.x / width_ * columns_ - 0.5, (1 - place.y / height_) * rows_ - 0.5};
}

std::optional<Place> ProjectorModel::placeOf(Pixel pixel) const {
  if (lens_) return lens_->toPlane(pixel, sensor_height_);
  return Place{(pixel.x + 0.5) / columns_ * width_, (1 - (pixel.y + 0.5) / rows_) * height_};
}

}  // namespace lab::optics
