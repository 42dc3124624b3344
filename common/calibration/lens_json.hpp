/// A camera's lens and pose in a calibration file.
#pragma once

#include <array>
#include <nlohmann/json.hpp>

#include "common/files/json_section.hpp"
#include "light/optics/camera_model.hpp"

namespace lab {

// Limits of every lens, also of files in other forms.
inline constexpr double kMostLensPixels = 1e6;  ///< [px] of focal lengths and centre
inline constexpr double kMostDistortion = 100;  ///< of k1, k2, p1, p2, k3

/// Checks that a rotation has orthonormal rows and determinant +1.
/// @param rotation row by row
/// @throws ExperimentError if not
void checkRotation(const JsonSection& file, const char* key, const std::array<double, 9>& rotation);

/// Reads lens and pose, as writeLens() writes them.
/// @param mirrored whether fx may be negative
/// @throws ExperimentError
[[nodiscard]] optics::CameraParameters readLens(const JsonSection& file, bool mirrored);

/// Writes the keys width_px, height_px, fx_px, fy_px, cx_px, cy_px, k1, k2, p1, p2, k3, rotation
/// (row by row) and translation_m.
void writeLens(nlohmann::ordered_json& file, const optics::CameraParameters& lens);

}  // namespace lab
