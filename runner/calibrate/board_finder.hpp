/// The board in a picture. Picture in, discs out.
#pragma once

#include <optional>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/calibration/board.hpp"
#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::runner {

/// All discs of the board, as a grid; which corner of it comes first is chance, and makes no
/// difference to a camera. Dark blobs that are as round as an ellipse are fitted like the circles
/// of caps; neighbours are followed from disc to disc, so that strangers beside the board do no
/// harm. Where it is not found so, the picture is read as one that was encoded for the eye.
/// @return empty where not every disc was found
[[nodiscard]] std::optional<calibration::BoardView> findBoard(const optics::GreyView& picture,
                                                              const calibration::BoardSpec& board);

}  // namespace lab::runner
