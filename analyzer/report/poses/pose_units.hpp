/// Checks whether headings and times of a file of poses can be in radians and seconds.
#pragma once

#include <string>
#include <vector>

#include "analyzer/report/poses/pose_file.hpp"

namespace lab::report {

/// Reasons against radians and against seconds, one sentence each with the likely cause; empty if
/// there are none. They are warnings: the recording is analyzed nevertheless.
///
/// Headings beyond +-2 pi are an unwrapped angle, or not in radians. An unwrapped angle changes by
/// at most pi between frames. Slow turns in degrees are recognised by the motion, which is along
/// theta pi / 180 and not along theta. Times with more than 5 s, or less than 1 ms, between frames
/// are hardly in s.
[[nodiscard]] std::vector<std::string> unitWarnings(const PoseFile& poses);

}  // namespace lab::report
