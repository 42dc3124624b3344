/// Camera, cap and imaging: constants shared by the steps of a detection.
#pragma once

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/detector/scale_map.hpp"

namespace lab::detector {

struct DetectorSetup {
  optics::CameraModel camera;
  optics::CapGeometry cap;
  optics::Imaging imaging;
  ScaleMap scale{camera, cap};
};

}  // namespace lab::detector
