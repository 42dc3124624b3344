#include "sim_svc/world/contact_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace lab::sim {
namespace {

// In units of the largest move. Robots are usually slower, so that the close pairs hold for tens of
// steps.
constexpr double kCloseMove = 2;

double squaredDistance(Vec a, Vec b) {
  const Vec apart = {a.x - b.x, a.y - b.y};
  return apart.x * apart.x + apart.y * apart.y;
}

}  // namespace

Vec wallNormal(std::uint32_t wall) {
  switch (wall - kFirstWall) {
    case 0:
      return {1, 0};
    case 1:
      return {-1, 0};
    case 2:
      return {0, 1};
    default:
      return {0, -1};
  }
}

double wallDistance(const Arena& arena, std::uint32_t wall, Vec point) {
  switch (wall - kFirstWall) {
    case 0:
      return point.x;
    case 1:
      return arena.width - point.x;
    case 2:
      return point.y;
    default:
      return arena.height - point.y;
  }
}

ContactPairs::ContactPairs(const Arena& arena, double radius, double largest_move)
    : arena_(arena),
      radius_(radius),
      largest_move_(largest_move),
      close_move_(kCloseMove * largest_move) {}

void ContactPairs::findNear(const MovedDisks& disks, std::vector<ContactPair>& pairs) {
  if (close_at_.size() != disks.bodies->centre.size() ||
      anyMoved(disks.bodies->centre, close_at_, close_move_)) {
    listClose(disks, pairs);
  }
  pairs.clear();
  const double distance = 2 * radius_ + largest_move_;
  for (const ClosePair close : close_) {
    const Vec centre = disks.to(close.first);
    if (isWall(close.second)) {
      const double gap = wallDistance(arena_, close.second, centre) - radius_;
      if (gap >= largest_move_) continue;
      pairs.push_back({.first = close.first, .second = close.second, .gap = gap});
      continue;
    }
    const double squared = squaredDistance(centre, disks.to(close.second));
    if (squared >= distance * distance) continue;
    pairs.push_back(
        {.first = close.first, .second = close.second, .gap = std::sqrt(squared) - 2 * radius_});
  }
}

void ContactPairs::findFar(const MovedDisks& disks, std::vector<ContactPair>& pairs) const {
  search(disks, kFarthestGap * largest_move_, kFarthestGap * largest_move_, pairs);
}

void ContactPairs::listClose(const MovedDisks& disks, std::vector<ContactPair>& scratch) {
  search(disks, largest_move_ + 2 * close_move_, largest_move_ + close_move_, scratch);
  close_.clear();
  for (const ContactPair& pair : scratch) close_.push_back({pair.first, pair.second});
  close_at_ = disks.bodies->centre;
}

void ContactPairs::search(const MovedDisks& disks, double pair_gap, double wall_gap,
                          std::vector<ContactPair>& pairs) const {
  pairs.clear();
  const double distance = 2 * radius_ + pair_gap;
  for (std::uint32_t i = 0; i < disks.robots; ++i) {
    const Vec centre = disks.to(i);
    const auto begin = static_cast<std::ptrdiff_t>(pairs.size());
    for (const std::uint32_t j : disks.neighbours->of(i)) {
      if (j < i) continue;
      const double squared = squaredDistance(centre, disks.to(j));
      if (squared >= distance * distance) continue;
      pairs.push_back({.first = i, .second = j, .gap = std::sqrt(squared) - 2 * radius_});
    }
    std::sort(pairs.begin() + begin, pairs.end(),
              [](const ContactPair& a, const ContactPair& b) { return a.second < b.second; });
    addWalls(i, centre, wall_gap, pairs);
  }
}

void ContactPairs::addWalls(std::uint32_t robot, Vec centre, double reach,
                            std::vector<ContactPair>& pairs) const {
  const double near = radius_ + reach;
  if (centre.x >= near && centre.x <= arena_.width - near && centre.y >= near &&
      centre.y <= arena_.height - near) {
    return;
  }
  for (std::uint32_t wall = kFirstWall; wall < kFirstWall + 4; ++wall) {
    const double gap = wallDistance(arena_, wall, centre) - radius_;
    if (gap < reach) pairs.push_back({.first = robot, .second = wall, .gap = gap});
  }
}

double ContactPairs::gapOf(const ContactPair& pair, Vec first, Vec second) const {
  if (isWall(pair.second)) return wallDistance(arena_, pair.second, first) - radius_;
  return std::sqrt(squaredDistance(first, second)) - 2 * radius_;
}

}  // namespace lab::sim
