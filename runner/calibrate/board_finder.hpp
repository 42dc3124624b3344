/// Finds the calibration board in a picture. Pure function.
#pragma once

#include <optional>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/calibration/board.hpp"
#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::runner {

/// Finds all discs of the board and orders them as a grid. Dark blobs with the area of an ellipse
/// are fitted as the circles of caps are; the grid grows from neighbour to neighbour, so other dark
/// objects do not disturb it. If the board is not found, the search is repeated with the picture
/// decoded by the video gamma. Which corner of the grid comes first is arbitrary: a camera fit does
/// not depend on it.
/// @return nothing if not every disc was found
[[nodiscard]] std::optional<calibration::BoardView> findBoard(const optics::GreyView& picture,
                                                              const calibration::BoardSpec& board);

}  // namespace lab::runner
