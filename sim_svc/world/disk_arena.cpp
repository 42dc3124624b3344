#include "sim_svc/world/disk_arena.hpp"

#include <algorithm>
#include <cmath>

#include "sim_svc/world/collision.hpp"

namespace lab::sim {
namespace {

double squared(Vec v) { return v.x * v.x + v.y * v.y; }

// Hidden kinematic disks lie far from the arena and from each other.
Vec hiddenPosition(std::size_t kinematic_body) {
  return {-1e6 * static_cast<double>(1 + kinematic_body), -1e6};
}

bool isHidden(Vec centre) { return centre.x <= -1e6; }

constexpr double kPushTime = 0.01;       // [s] that a push out of a kinematic disk is taken to last
constexpr double kLeastProgress = 1e-6;  // [m] of such a push

}  // namespace

DiskArena::DiskArena(const DiskArenaSettings& settings, const std::vector<dynamics::Pose>& robots)
    : settings_(settings),
      contact_distance_(2 * settings.radius + kContactGap),
      skin_(settings.radius),
      robots_(robots.size()),
      sliding_({settings.arena, settings.radius, settings.largest_move, settings.friction,
                settings.mobility}),
      contacts_(robots.size()) {
  for (const dynamics::Pose& pose : robots) {
    bodies_.add(pose);
  }
  if (slides()) from_ = bodies_.centre;
  listNeighbours();
}

void DiskArena::beginStep() {
  ++steps_;
  if (slides() || visible_kinematic_ == 0) return;
  for (std::size_t body = robots_; body < bodies_.centre.size(); ++body) {
    pushRobotsOut(body);
  }
}

void DiskArena::setMotion(std::size_t i, Motion motion) {
  bodies_.speed[i] = motion.speed;
  bodies_.turn[i] = motion.turn;
  bodies_.setTheta(i, bodies_.theta[i]);
}

Velocity DiskArena::velocity(std::size_t i) const {
  const bool touches = touchesRobot(i) || touchesWall(i);
  const double speed = touches && !slides() ? 0 : bodies_.speed[i];
  Velocity velocity{{speed * bodies_.heading_x[i], speed * bodies_.heading_y[i]}, bodies_.turn[i]};
  if (!touches || !slides()) return velocity;
  const Velocity& slip = contacts_[i].slip;
  velocity.linear = {velocity.linear.x + slip.linear.x, velocity.linear.y + slip.linear.y};
  velocity.turn += slip.turn;
  return velocity;
}

void DiskArena::moveUntilContact(std::size_t i, double dt) {
  const dynamics::Arc arc = dynamics::makeArcOf(bodies_.speed[i], bodies_.turn[i], dt);
  const Vec move = stopAtContact(i, bodies_.along(i, arc));
  bodies_.centre[i].x += move.x;
  bodies_.centre[i].y += move.y;
  bodies_.rotate(i, arc);
}

void DiskArena::displace(std::size_t i, double forward, double rotation) {
  forward = std::clamp(forward, -settings_.largest_move, settings_.largest_move);
  Vec move = {forward * bodies_.heading_x[i], forward * bodies_.heading_y[i]};
  if (!slides()) move = stopAtContact(i, move);
  bodies_.centre[i].x += move.x;
  bodies_.centre[i].y += move.y;
  bodies_.turned[i] += rotation;
  bodies_.setTheta(i, bodies_.theta[i] + rotation);
}

void DiskArena::endStep(double dt, WorkerTeam& team) {
  if (!slides()) return;
  sliding_.resolve(moved(), dt, team);
  applyContacts(dt);
  std::fill_n(bodies_.turned.begin(), robots_, 0.0);
  std::copy(bodies_.centre.begin(), bodies_.centre.end(), from_.begin());
  if (anyMoved(std::span(bodies_.centre).first(robots_), listed_at_, skin_ / 2)) listNeighbours();
}

MovedDisks DiskArena::moved() const { return {robots_, from_, &bodies_, &neighbours_}; }

void DiskArena::applyContacts(double dt) {
  for (const ContactShift& shift : sliding_.shifts()) {
    Vec& centre = bodies_.centre[shift.robot];
    centre.x += shift.shift.x;
    centre.y += shift.shift.y;
    if (shift.rotation != 0) {
      bodies_.setTheta(shift.robot, bodies_.theta[shift.robot] + shift.rotation);
    }
    contacts_[shift.robot].slip = {{shift.shift.x / dt, shift.shift.y / dt}, shift.rotation / dt};
  }
  for (const Touch& touched : sliding_.touches()) {
    if (touched.other == Touch::kWall) {
      touch(contacts_[touched.robot].wall);
      continue;
    }
    touch(contacts_[touched.robot].robot);
    if (touched.other < robots_) touch(contacts_[touched.other].robot);
    collisions_ += touched.begun ? 1 : 0;
  }
}

// The part of `move` up to the first contact, which is counted.
Vec DiskArena::stopAtContact(std::size_t i, Vec move) {
  const Vec from = bodies_.centre[i];
  const double reach = contact_distance_ + settings_.largest_move;
  const double wall_share = freeShareToWalls(settings_.arena, settings_.radius, from, move);
  double share = wall_share;
  std::size_t touched = i;
  for (const std::uint32_t j : neighbours_.of(i)) {
    const Vec to_other = {bodies_.centre[j].x - from.x, bodies_.centre[j].y - from.y};
    if (squared(to_other) >= reach * reach) {
      continue;
    }
    const double free = freeShareToDisk(to_other, move, contact_distance_ * contact_distance_);
    if (free < share) {
      share = free;
      touched = j;
    }
  }
  if (share == 1) {
    return move;
  }
  if (touched == i) {
    touch(contacts_[i].wall);
  } else {
    const bool begun = touch(contacts_[i].robot);
    touch(contacts_[touched].robot);
    collisions_ += begun ? 1 : 0;
  }
  return {share * move.x, share * move.y};
}

// Marks a contact in this step. Returns true if there was none in the previous step.
bool DiskArena::touch(Contact& contact) const {
  const bool begun = contact.last_step < steps_ - 1;
  contact.begun += begun ? 1 : 0;
  contact.last_step = steps_;
  return begun;
}

void DiskArena::relistIfMoved(std::size_t i) {
  const Vec listed_at = listed_at_[i];
  const Vec moved = {bodies_.centre[i].x - listed_at.x, bodies_.centre[i].y - listed_at.y};
  if (squared(moved) > skin_ * skin_ / 4) {
    listNeighbours();
  }
}

void DiskArena::listNeighbours() {
  const double contact_gap = slides() ? SlidingContacts::kFarthestGap + 1 : 1;
  const double reach = std::max(2 * settings_.radius + settings_.sensing_range,
                                contact_distance_ + contact_gap * settings_.largest_move);
  neighbours_.build(bodies_.centre, settings_.arena, reach + skin_ + settings_.largest_move);
  listed_at_ = bodies_.centre;
}

std::size_t DiskArena::addKinematicDisk() {
  const std::size_t disk = contacts_.size() - robots_;
  contacts_.emplace_back();
  const Vec hidden = hiddenPosition(contacts_.size());
  bodies_.add({hidden.x, hidden.y, 0});
  if (slides()) from_.push_back(hidden);
  listNeighbours();
  return disk;
}

void DiskArena::moveKinematicDisk(std::size_t disk, Vec centre) {
  if (!std::isfinite(centre.x) || !std::isfinite(centre.y)) {
    hideKinematicDisk(disk);
    return;
  }
  const std::size_t body = robots_ + disk;
  const bool appears = isHidden(bodies_.centre[body]);
  if (appears) ++visible_kinematic_;
  bodies_.centre[body] = centre;
  relistIfMoved(body);
  if (!slides()) {
    pushRobotsOut(body);
    return;
  }
  if (appears) from_[body] = centre;
  pushOutSliding(body);
  from_[body] = centre;
}

void DiskArena::hideKinematicDisk(std::size_t disk) {
  const std::size_t body = robots_ + disk;
  if (!isHidden(bodies_.centre[body])) --visible_kinematic_;
  bodies_.centre[body] = hiddenPosition(body);
  if (slides()) from_[body] = bodies_.centre[body];
}

// Pushes robots out of a kinematic disk in pieces of at most the largest move, for which the
// neighbour lists are valid, as long as that brings them farther out.
void DiskArena::pushOutSliding(std::size_t kinematic_body) {
  double overlap = deepestOverlap(kinematic_body);
  while (overlap > SlidingContacts::kSlack) {
    sliding_.pushOut(moved());
    applyContacts(kPushTime);
    std::copy_n(bodies_.centre.begin(), robots_, from_.begin());
    from_[kinematic_body] = bodies_.centre[kinematic_body];
    for (std::size_t i = 0; i < robots_; ++i) relistIfMoved(i);
    const double left = deepestOverlap(kinematic_body);
    if (left > overlap - kLeastProgress) return;
    overlap = left;
  }
}

double DiskArena::deepestOverlap(std::size_t kinematic_body) const {
  double deepest = 0;
  for (const std::uint32_t i : neighbours_.of(kinematic_body)) {
    if (i >= robots_) continue;
    const Vec apart = {bodies_.centre[i].x - bodies_.centre[kinematic_body].x,
                       bodies_.centre[i].y - bodies_.centre[kinematic_body].y};
    deepest = std::max(deepest, 2 * settings_.radius - std::sqrt(squared(apart)));
  }
  return deepest;
}

void DiskArena::pushRobotsOut(std::size_t kinematic_body) {
  // A copy, because pushing may rebuild the lists.
  const auto listed = neighbours_.of(kinematic_body);
  const std::vector<std::uint32_t> near(listed.begin(), listed.end());
  for (const std::uint32_t i : near) {
    if (i < robots_) {
      pushOut(i, kinematic_body);
    }
  }
}

// Pushes in pieces of at most the largest move, for which the neighbour lists are valid.
void DiskArena::pushOut(std::size_t i, std::size_t kinematic_body) {
  for (;;) {
    const Vec away = {bodies_.centre[i].x - bodies_.centre[kinematic_body].x,
                      bodies_.centre[i].y - bodies_.centre[kinematic_body].y};
    const double distance = std::hypot(away.x, away.y);
    const double depth = contact_distance_ - distance;
    // Within the gap that robots keep, the disks only touch and do not overlap.
    if (depth <= kContactGap) {
      return;
    }
    const Vec direction =
        distance > 0 ? Vec{away.x / distance, away.y / distance} : bodies_.heading(i);
    const double piece = std::min(depth, settings_.largest_move);
    const Vec move = stopAtContact(i, {piece * direction.x, piece * direction.y});
    bodies_.centre[i].x += move.x;
    bodies_.centre[i].y += move.y;
    relistIfMoved(i);
    if (touch(contacts_[i].robot)) {
      ++collisions_;
    }
    if (std::hypot(move.x, move.y) < piece / 2) {
      return;
    }
  }
}

}  // namespace lab::sim
