#include "sim_svc/placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <unordered_set>

#include "common/math/random.hpp"

namespace lab::sim {
namespace {

constexpr int kTries = 2000;
constexpr double kClearance = 1e-4;  // m between robots placed at random
constexpr int kShakes = 300;
// A robot that starts at a wall within the range of its infrared sensors, or in a corner, may turn
// back again and again, or push against the wall for minutes.
constexpr double kWallClearance = 0.05;  // m
constexpr int kTriesClearOfWalls = 1000;
constexpr double kMostOfArena = 0.2;  // that the clearance takes at each side

using dynamics::Pose;

/// Places by cells, so that only the neighbours of a place are looked at.
class PlaceGrid {
 public:
  /// @param distance up to which neighbours are found [m]
  PlaceGrid(const Arena& arena, double distance, std::size_t places) : next_(places, kNone) {
    // In an arena much larger than the robots need, larger cells save memory.
    const double per_place =
        std::sqrt(arena.width * arena.height / static_cast<double>(places + 1));
    cell_ = std::max(distance, per_place / 2);
    columns_ = static_cast<std::size_t>(arena.width / cell_) + 1;
    rows_ = static_cast<std::size_t>(arena.height / cell_) + 1;
    first_.assign(columns_ * rows_, kNone);
  }

  void add(std::size_t i, const Pose& pose) {
    std::size_t& first = first_[row(pose.y) * columns_ + column(pose.x)];
    next_[i] = first;
    first = i;
  }

  /// @param pose at which it was added
  void remove(std::size_t i, const Pose& pose) {
    std::size_t* link = &first_[row(pose.y) * columns_ + column(pose.x)];
    while (*link != i) link = &next_[*link];
    *link = next_[i];
  }

  /// Calls visit(j) for all places within the distance of `pose`, and for others near it.
  template <class Visit>
  void visitNear(const Pose& pose, const Visit& visit) const {
    const std::size_t c = column(pose.x);
    const std::size_t r = row(pose.y);
    for (std::size_t y = r == 0 ? 0 : r - 1; y <= std::min(r + 1, rows_ - 1); ++y) {
      for (std::size_t x = c == 0 ? 0 : c - 1; x <= std::min(c + 1, columns_ - 1); ++x) {
        for (std::size_t j = first_[y * columns_ + x]; j != kNone; j = next_[j]) visit(j);
      }
    }
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  [[nodiscard]] std::size_t column(double x) const {
    return std::min(static_cast<std::size_t>(std::max(x, 0.0) / cell_), columns_ - 1);
  }
  [[nodiscard]] std::size_t row(double y) const {
    return std::min(static_cast<std::size_t>(std::max(y, 0.0) / cell_), rows_ - 1);
  }

  double cell_ = 0;  // [m]
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<std::size_t> first_;  // per cell: a place, or kNone
  std::vector<std::size_t> next_;   // per place: another one in the same cell, or kNone
};

/// The poses assigned so far, by robot.
class PlacementSearch {
 public:
  PlacementSearch(const std::vector<Place>& places, const Arena& arena, double radius,
                  std::uint64_t seed)
      : places_(places),
        arena_(arena),
        radius_(radius),
        seed_(seed),
        poses_(places.size()),
        placed_(arena, 2 * radius + kClearance, places.size()) {
    placeGiven();
  }

  std::vector<Pose> place() {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (!places_[i].given && !placeAtRandom(i)) {
        placeOnLattice();
        perturb();
        break;
      }
    }
    return poses_;
  }

 private:
  void placeGiven() {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (!places_[i].given) continue;
      poses_[i] = *places_[i].given;
      const std::string name = "robot " + std::to_string(places_[i].id);
      if (!isInside(poses_[i])) {
        throw std::invalid_argument(name + " has a start pose outside the arena");
      }
      if (const auto other = overlapping(poses_[i], i, 0)) {
        throw std::invalid_argument(name + " has a start pose that overlaps robot " +
                                    std::to_string(places_[*other].id));
      }
      placed_.add(i, poses_[i]);
    }
  }

  bool placeAtRandom(std::size_t i) {
    Random random(deriveSeed(seed_, places_[i].id, "place"));
    Pose pose;
    pose.theta = (2 * random.uniform() - 1) * std::numbers::pi;
    const auto within = [&](double extent, bool clear) {
      const double free = extent - 2 * radius_;
      const double clearance = clear ? std::min(kWallClearance, kMostOfArena * free) : 0;
      return radius_ + clearance + random.uniform() * (free - 2 * clearance);
    };
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const bool clear = attempt < kTriesClearOfWalls;
      pose.x = within(arena_.width, clear);
      pose.y = within(arena_.height, clear);
      if (!overlapping(pose, i, kClearance)) {
        poses_[i] = pose;
        placed_.add(i, pose);
        return true;
      }
    }
    return false;
  }

  void placeOnLattice() {
    placed_ = PlaceGrid(arena_, 2 * radius_ + kClearance, places_.size());
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (places_[i].given) placed_.add(i, poses_[i]);
    }
    std::vector<Pose> sites = freeSites();
    Random random(deriveSeed(seed_, 0, "lattice"));
    std::size_t next = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (places_[i].given) continue;
      if (next == sites.size()) {
        throw std::invalid_argument("no room for " + std::to_string(places_.size()) +
                                    " robots in the arena");
      }
      const auto left = static_cast<double>(sites.size() - next);
      std::swap(sites[next], sites[next + static_cast<std::size_t>(random.uniform() * left)]);
      poses_[i] = sites[next++];
      poses_[i].theta =
          (2 * Random(deriveSeed(seed_, places_[i].id, "place")).uniform() - 1) * std::numbers::pi;
      placed_.add(i, poses_[i]);
    }
  }

  std::vector<Pose> freeSites() const {
    const double pitch = 2 * radius_ + kClearance;
    const double row_pitch = pitch * std::numbers::sqrt3 / 2;
    const auto rows = static_cast<int>((arena_.height - 2 * radius_) / row_pitch) + 1;
    const auto columns = static_cast<int>((arena_.width - 2 * radius_) / pitch) + 1;
    std::vector<Pose> sites;
    for (int row = 0; row < rows; ++row) {
      const double shift = row % 2 == 0 ? 0 : pitch / 2;
      for (int column = 0; column < columns; ++column) {
        const Pose site{radius_ + shift + column * pitch, radius_ + row * row_pitch, 0};
        if (isInside(site) && !overlapping(site, places_.size(), kClearance / 2)) {
          sites.push_back(site);
        }
      }
    }
    return sites;
  }

  // Applies random small moves of hard disks, so that the lattice disappears.
  void perturb() {
    Random random(deriveSeed(seed_, 0, "shake"));
    const double step = radius_ / 2;
    for (int round = 0; round < kShakes; ++round) {
      for (std::size_t i = 0; i < places_.size(); ++i) {
        Pose pose = poses_[i];
        pose.x += (2 * random.uniform() - 1) * step;
        pose.y += (2 * random.uniform() - 1) * step;
        if (!places_[i].given && isInside(pose) && !overlapping(pose, i, kClearance / 2)) {
          placed_.remove(i, poses_[i]);
          placed_.add(i, pose);
          poses_[i] = pose;
        }
      }
    }
  }

  bool isInside(const Pose& pose) const {
    return pose.x >= radius_ && pose.x <= arena_.width - radius_ && pose.y >= radius_ &&
           pose.y <= arena_.height - radius_;
  }

  // The first placed robot other than i that a robot at `pose` would be too close to.
  std::optional<std::size_t> overlapping(const Pose& pose, std::size_t i, double clearance) const {
    const double distance = 2 * radius_ + clearance;
    std::optional<std::size_t> first;
    placed_.visitNear(pose, [&](std::size_t j) {
      if (j == i || (first && *first < j)) return;
      const double dx = poses_[j].x - pose.x;
      const double dy = poses_[j].y - pose.y;
      // hypot() is slow; most places are far from the limit.
      if (dx * dx + dy * dy > 1.001 * distance * distance) return;
      if (std::hypot(dx, dy) < distance) first = j;
    });
    return first;
  }

  const std::vector<Place>& places_;
  Arena arena_;
  double radius_;
  std::uint64_t seed_;
  std::vector<Pose> poses_;
  PlaceGrid placed_;
};

}  // namespace

std::vector<Pose> placeRobots(const std::vector<Place>& places, const Arena& arena, double radius,
                              std::uint64_t seed) {
  std::unordered_set<std::int32_t> ids;
  ids.reserve(places.size());
  for (const Place& place : places) {
    if (!ids.insert(place.id).second) {
      throw std::invalid_argument("robot " + std::to_string(place.id) + " is listed twice");
    }
  }
  return PlacementSearch(places, arena, radius, seed).place();
}

}  // namespace lab::sim
