/// Whether the numbers of a file of poses can be in the units that they are read in.
#pragma once

#include <string>
#include <vector>

#include "analyzer/report/poses/pose_file.hpp"

namespace lab::report {

/// What speaks against radians and against seconds, each in a sentence with the likely cause; empty
/// where nothing does. For people: a recording that is doubted is analyzed all the same.
///
/// Headings beyond +-2 pi are those of an unwrapped angle, or no radians. An unwrapped one turns by
/// at most pi from frame to frame (so it is made). One that turns slowly is told by the motion,
/// which is along the axis of theta pi / 180 and not along that of theta. A recording with less
/// than 5 s between its pictures may have its times in anything; one with more has them hardly in
/// s.
[[nodiscard]] std::vector<std::string> unitWarnings(const PoseFile& poses);

}  // namespace lab::report
