#include "tracker_svc/circle_search/candidate.hpp"

#include <algorithm>
#include <cstddef>

namespace lab::detector {
namespace {

constexpr int kStandOut = 3;  // [noise / 4] by which the mean around exceeds the mean inside

}  // namespace

void moveToMiddle(const Plane& plane, Candidate& candidate) {
  const std::uint8_t* at = plane.view.row(candidate.y) + candidate.x;
  const int level = (candidate.dark + candidate.white) / 2;
  const auto far = [&](std::ptrdiff_t step) {
    int rows = 1;
    while (rows <= candidate.to.across && at[rows * step] < level) ++rows;
    return rows;
  };
  candidate.y += (far(plane.view.stride) - far(-plane.view.stride)) / 2;
}

bool isRound(const Plane& plane, const Candidate& candidate) {
  const std::uint8_t* at = plane.view.row(candidate.y) + candidate.x;
  const std::ptrdiff_t stride = plane.view.stride;
  const std::ptrdiff_t near = candidate.to.near;
  const std::ptrdiff_t across = candidate.to.across;
  const std::ptrdiff_t diagonal = candidate.to.diagonal;
  const int level = (candidate.dark + candidate.white) / 2;
  int inside = 0;
  for (const std::ptrdiff_t to : {near, near * stride}) {
    inside = std::max<int>(inside, std::max(at[to], at[-to]));
  }
  int outside = 255;
  for (const std::ptrdiff_t to :
       {across, across * stride, diagonal * (stride + 1), diagonal * (stride - 1)}) {
    outside = std::min<int>(outside, std::min(at[to], at[-to]));
  }
  return inside < level && level < outside;
}

bool isDark(const Plane& plane, const GreyLevels& levels, Candidate& candidate) {
  const std::uint8_t* at = plane.view.row(candidate.y) + candidate.x;
  const std::ptrdiff_t stride = plane.view.stride;
  const std::ptrdiff_t across = candidate.to.across;
  const std::ptrdiff_t diagonal = candidate.to.diagonal;
  candidate.dark = at[0];
  candidate.white = 0;
  for (const std::ptrdiff_t to :
       {across, across * stride, diagonal * (stride + 1), diagonal * (stride - 1)}) {
    candidate.white = std::max<int>(candidate.white, std::min(at[to], at[-to]));
  }
  return 2 * (candidate.dark - levels.black) + levels.noise <= candidate.white - levels.black &&
         !isFaint(candidate, levels);
}

bool standsOut(const Plane& plane, const Candidate& candidate, int noise) {
  const std::uint8_t* at = plane.view.row(candidate.y) + candidate.x;
  const std::ptrdiff_t stride = plane.view.stride;
  const std::ptrdiff_t near = candidate.to.near;
  const std::ptrdiff_t across = candidate.to.across;
  const std::ptrdiff_t diagonal = candidate.to.diagonal;
  const int inner = at[0] + at[near] + at[-near] + at[near * stride] + at[-near * stride];
  // Values are limited, so that bright light on one side does not outweigh dark pixels on the
  // others.
  const int most = candidate.white + noise / 4;
  int outer = 0;
  for (const std::ptrdiff_t to :
       {across, across * stride, diagonal * (stride + 1), diagonal * (stride - 1)}) {
    outer += std::min<int>(at[to], most) + std::min<int>(at[-to], most);
  }
  // The mean of eight less the mean of five, in units of 1/40 DN.
  return 5 * outer - 8 * inner >= 40 * kStandOut * noise / 4;
}

}  // namespace lab::detector
