/// The light in the arena as a small picture.
#pragma once

#include <cstdint>
#include <lab/light_status_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "light/field/image.hpp"
#include "light/field/raster.hpp"

namespace lab::dashboard {

/// Paints the newest LIGHT_STATUS.
class LightPicture {
 public:
  static constexpr std::int64_t kPeriod_us = 200'000;  ///< 5 Hz
  static constexpr int kColumns = 120;

  /// @param width,height of the arena [m]
  void setArena(double width, double height);
  void setImages(light::ImageStore images);

  void take(const light_status_t& status);
  void clear();

  /// Paints the light if it has changed and the last picture is at least kPeriod_us old.
  /// @return whether picture or text are new
  bool paint(std::int64_t now);

  [[nodiscard]] bool known() const { return status_.has_value(); }
  [[nodiscard]] const std::optional<light_status_t>& status() const { return status_; }

  /// JSON of topic `light`.
  /// @param runner sender of the script's light
  [[nodiscard]] std::string json(const std::string& runner) const;

  /// kColumns x rows bytes, 0 is dark, the top row first.
  [[nodiscard]] const std::vector<std::uint8_t>& pixels() const { return pixels_; }

 private:
  [[nodiscard]] int rows() const;

  double width_ = 1.2;
  double height_ = 0.9;
  light::ImageStore images_;
  std::optional<light_status_t> status_;
  std::optional<light::Field> painted_;
  std::optional<light::FramePainter> painter_;
  std::int64_t painted_utime_ = 0;
  bool changed_ = false;
  std::vector<std::uint8_t> pixels_;
  std::int64_t version_ = 0;
  double mean_ = 0;
  std::string trouble_;  ///< why the light cannot be painted
};

}  // namespace lab::dashboard
