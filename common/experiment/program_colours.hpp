/// The colours of programs: the same in the dashboard, the report and the preview.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <iterator>
#include <string>

#include "common/experiment/experiment.hpp"
#include "light/optics/rgb_image.hpp"

namespace lab {

/// Okabe and Ito's palette, which colour-blind readers can distinguish, and a grey.
inline constexpr std::array<optics::Colour, 7> kProgramColours{{{0, 114, 178},
                                                                {213, 94, 0},
                                                                {0, 158, 115},
                                                                {204, 121, 167},
                                                                {230, 159, 0},
                                                                {86, 180, 233},
                                                                {140, 140, 140}}};

/// Counts the experiment's programs in the order of their names.
/// @param unnamed the place, after the experiment's programs, of a program that it does not name
[[nodiscard]] inline std::size_t programPlace(const Experiment& experiment, const std::string& name,
                                              std::size_t unnamed = 0) {
  const auto program = experiment.programs.find(name);
  const auto place = std::distance(experiment.programs.begin(), program);
  return static_cast<std::size_t>(place) + (program == experiment.programs.end() ? unnamed : 0);
}

/// By the place of the program; the eighth one has the colour of the first.
[[nodiscard]] inline optics::Colour programColour(const Experiment& experiment,
                                                  const std::string& name,
                                                  std::size_t unnamed = 0) {
  return kProgramColours[programPlace(experiment, name, unnamed) % kProgramColours.size()];
}

/// "#0072B2"
[[nodiscard]] inline std::string hexText(optics::Colour colour) {
  return fmt::format("#{:02X}{:02X}{:02X}", colour.red, colour.green, colour.blue);
}

}  // namespace lab
