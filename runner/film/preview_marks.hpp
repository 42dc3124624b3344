/// What a preview draws beside the light: the regions of the bands, the scale, and the robots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "light/field/raster.hpp"
#include "light/optics/rgb_image.hpp"
#include "projector_ctl/scene.hpp"

namespace lab::runner {

/// Draws the marks into pictures of one width. The programs have the colours of the
/// dashboard.
class PreviewMarks {
 public:
  /// @param width of the pictures [px]
  /// @param arena_width of the arena in them [px]
  /// @param with_robots whether robots are drawn: the head says so
  PreviewMarks(const Experiment& experiment, int width, int arena_width, bool with_robots);

  /// Height of the head above the arena [px].
  [[nodiscard]] int headHeight() const;

  /// Writes the head: the caption, and the programs with the light that selects each. Programs that
  /// no light of the picture selects are grey.
  void drawHead(optics::RgbImage& image, const std::string& caption,
                const light::Raster& light) const;

  /// Outlines the region of each band in the colour of its program.
  /// @param light of the arena, as large as in the picture
  void drawBands(optics::RgbImage& image, const light::Raster& light) const;

  /// A bar with its length in cm in the lower left corner of the picture.
  void drawScale(optics::RgbImage& image) const;

  /// Discs with the heading, and with the id where there is room for it.
  void drawRobots(optics::RgbImage& image, const projector::ObservedFrame& frame) const;

 private:
  struct Entry {
    std::string text;
    optics::Colour colour;
    int x = 0;
    int row = 0;
  };

  [[nodiscard]] int bandAt(double light) const;
  [[nodiscard]] bool isSelected(std::size_t band, const light::Raster& light) const;

  int width_;
  double scale_;         ///< [px/m]
  double arena_height_;  ///< [m]
  double radius_;        ///< of a robot [m]
  std::vector<LightBand> bands_;
  std::vector<optics::Colour> colours_;  ///< of the bands
  std::vector<Entry> legend_;            ///< of the bands, and of the robots
};

}  // namespace lab::runner
