#include "tracker_svc/blobs/blob_areas.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace lab::detector {
namespace {

struct Step {
  int x, y;
};
// Four direct neighbours, then four diagonal ones.
constexpr std::array<Step, 8> kSteps{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

void note(std::vector<int>& neighbours, int region) {
  const auto at = std::lower_bound(neighbours.begin(), neighbours.end(), region);
  if (at == neighbours.end() || *at != region) neighbours.insert(at, region);
}

}  // namespace

std::vector<BlobArea> BlobAreas::grow(const std::vector<PixelRegion>& regions, int width,
                                      int height, int edge, int ground, int close) {
  owner_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  steps_.resize(owner_.size(), 0);
  const auto at = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  std::vector<BlobArea> areas(regions.size());
  struct Front {
    AreaPixel pixel;
    std::size_t region;
  };
  std::vector<Front> front;
  std::vector<Front> next;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    for (const PixelRun& run : regions[i].runs) {
      for (int x = run.first; x <= run.last; ++x) {
        owner_[at(x, run.y)] = static_cast<std::int32_t>(i + 1);
        steps_[at(x, run.y)] = 0;
        const AreaPixel pixel{x, run.y, 0};
        areas[i].pixels.push_back(pixel);
        front.push_back({pixel, i});
      }
    }
  }
  for (int step = 1; step <= edge + ground; ++step) {
    next.clear();
    const std::size_t ways = step % 2 == 0 ? 8 : 4;
    for (const Front& from : front) {
      for (std::size_t way = 0; way < ways; ++way) {
        const AreaPixel to{from.pixel.x + kSteps[way].x, from.pixel.y + kSteps[way].y, step};
        if (to.x < 0 || to.y < 0 || to.x >= width || to.y >= height) {
          if (step <= edge) areas[from.region].cut = true;
          continue;
        }
        std::int32_t& owner = owner_[at(to.x, to.y)];
        if (owner == 0) {
          owner = static_cast<std::int32_t>(from.region + 1);
          steps_[at(to.x, to.y)] = static_cast<std::uint8_t>(step);
          areas[from.region].pixels.push_back(to);
          next.push_back({to, from.region});
        } else if (static_cast<std::size_t>(owner) != from.region + 1 && step <= close &&
                   steps_[at(to.x, to.y)] <= close) {
          note(areas[from.region].neighbours, owner - 1);
          note(areas[static_cast<std::size_t>(owner - 1)].neighbours,
               static_cast<int>(from.region));
        }
      }
    }
    front.swap(next);
  }
  for (const BlobArea& area : areas) {
    for (const AreaPixel& pixel : area.pixels) owner_[at(pixel.x, pixel.y)] = 0;
  }
  return areas;
}

}  // namespace lab::detector
