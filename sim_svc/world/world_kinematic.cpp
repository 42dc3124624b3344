// Disks that something outside the world moves, and how the robots yield to them.
#include <algorithm>
#include <cmath>

#include "sim_svc/world.hpp"
#include "sim_svc/world/collision.hpp"

namespace lab::sim {
namespace {

// Hidden ghosts wait far from the arena and from each other.
Vec hidingPlace(std::size_t ghost_body) {
  return {-1e6 * static_cast<double>(1 + ghost_body), -1e6};
}

bool isHidden(Vec centre) { return centre.x <= -1e6; }

}  // namespace

std::size_t World::addKinematicDisk() {
  const std::size_t ghost = bodies_.size() - size();
  bodies_.emplace_back();
  centres_.push_back(hidingPlace(bodies_.size()));
  listNeighbours();
  return ghost;
}

void World::moveKinematicDisk(std::size_t ghost, Vec centre) {
  if (!std::isfinite(centre.x) || !std::isfinite(centre.y)) {
    hideKinematicDisk(ghost);
    return;
  }
  const std::size_t body = size() + ghost;
  if (isHidden(centres_[body])) ++shown_kinematic_;
  centres_[body] = centre;
  relistIfMoved(body);
  makeRoom(body);
}

void World::hideKinematicDisk(std::size_t ghost) {
  const std::size_t body = size() + ghost;
  if (!isHidden(centres_[body])) --shown_kinematic_;
  centres_[body] = hidingPlace(body);
}

void World::makeRoom(std::size_t ghost_body) {
  // Copied: pushing may list the neighbours anew.
  const auto listed = neighbours_.of(ghost_body);
  const std::vector<std::uint32_t> near(listed.begin(), listed.end());
  for (const std::uint32_t i : near) {
    if (i < size()) {
      pushOut(i, ghost_body);
    }
  }
}

// In pieces that the neighbour list allows for.
void World::pushOut(std::size_t i, std::size_t ghost_body) {
  for (;;) {
    const Vec away = {centres_[i].x - centres_[ghost_body].x,
                      centres_[i].y - centres_[ghost_body].y};
    const double distance = std::hypot(away.x, away.y);
    const double depth = contact_distance_ - distance;
    // What only touches is left alone: a push by less than the gap that robots keep is none.
    if (depth <= kContactGap) {
      return;
    }
    const Vec direction =
        distance > 0 ? Vec{away.x / distance, away.y / distance} : bodies_[i].heading;
    const double piece = std::min(depth, largest_move_);
    const Vec move = stopAtContact(i, {piece * direction.x, piece * direction.y});
    centres_[i].x += move.x;
    centres_[i].y += move.y;
    relistIfMoved(i);
    if (touch(bodies_[i].robot_contact)) {
      ++collisions_;
    }
    if (std::hypot(move.x, move.y) < piece / 2) {
      return;
    }
  }
}

}  // namespace lab::sim
