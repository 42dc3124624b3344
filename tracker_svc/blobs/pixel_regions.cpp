#include "tracker_svc/blobs/pixel_regions.hpp"

#include <algorithm>
#include <limits>

namespace lab::detector {

void RegionFinder::begin() {
  runs_.clear();
  parents_.clear();
  row_ = above_ = above_end_ = 0;
}

std::size_t RegionFinder::rootOf(std::size_t run) {
  while (parents_[run] != run) run = parents_[run] = parents_[parents_[run]];
  return run;
}

void RegionFinder::add(const PixelRun& run) {
  if (!runs_.empty() && run.y != runs_.back().y) {
    const bool adjacent = run.y == runs_.back().y + 1;
    above_ = adjacent ? row_ : runs_.size();
    above_end_ = row_ = runs_.size();
  }
  const std::size_t own = runs_.size();
  runs_.push_back(run);
  parents_.push_back(own);
  while (above_ < above_end_ && runs_[above_].last < run.first - 1) ++above_;
  for (std::size_t i = above_; i < above_end_ && runs_[i].first <= run.last + 1; ++i) {
    const std::size_t a = rootOf(i);
    const std::size_t b = rootOf(own);
    parents_[std::max(a, b)] = std::min(a, b);
  }
}

std::vector<PixelRegion> RegionFinder::regions() {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> number(runs_.size(), kNone);
  std::vector<PixelRegion> regions;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const std::size_t root = rootOf(i);
    const PixelRun& run = runs_[i];
    if (number[root] == kNone) {
      number[root] = regions.size();
      regions.push_back({{}, 0, run.first, run.y, run.last, run.y});
    }
    PixelRegion& region = regions[number[root]];
    region.runs.push_back(run);
    region.pixels += run.last - run.first + 1;
    region.x0 = std::min(region.x0, run.first);
    region.x1 = std::max(region.x1, run.last);
    region.y1 = std::max(region.y1, run.y);
  }
  return regions;
}

}  // namespace lab::detector
