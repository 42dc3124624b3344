#include "sim_svc/world/sliding_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lab::sim {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
// Walls as partners: left, right, bottom, top.
constexpr std::uint32_t kFirstWall = kNone - 4;

// A kinematic disk pushes with at most this, in units of the largest move: more than the pushes of
// a column of robots, and less than infinite, so that a robot between a kinematic disk and a wall
// overlaps the disk and not the wall.
constexpr double kMostPush = 64;

constexpr int kMostHalvings = 8;

constexpr std::size_t kContactsOfARun = 200;

// In units of the largest move. Robots are usually slower, so that the close pairs hold for tens of
// steps.
constexpr double kCloseMove = 2;

bool isWall(std::uint32_t partner) { return partner >= kFirstWall; }

double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y; }

Vec difference(Vec a, Vec b) { return {a.x - b.x, a.y - b.y}; }

Vec sum(Vec a, Vec b) { return {a.x + b.x, a.y + b.y}; }

// Into the arena.
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

}  // namespace

SlidingContacts::SlidingContacts(const SlidingSettings& settings)
    : settings_(settings),
      solvers_(1, ContactSolver(settings.mobility, settings.friction)),
      most_push_(kMostPush * settings.largest_move / std::min(1.0, settings.mobility.across)),
      close_move_(kCloseMove * settings.largest_move) {}

void SlidingContacts::resolve(const MovedDisks& disks, double dt, WorkerTeam& team) {
  parent_.resize(disks.robots, kNone);
  slot_.resize(disks.robots, kNone);
  findPairs(disks, settings_.largest_move);
  takePushes(previous_, previous_dt_ > 0 ? dt / previous_dt_ : 0, false);
  run(disks, false, team);
  previous_.clear();
  for (const Pair& pair : pairs_) {
    if (pair.normal_push > 0) previous_.push_back(pair);
  }
  previous_dt_ = dt;
}

void SlidingContacts::pushOut(const MovedDisks& disks) {
  parent_.resize(disks.robots, kNone);
  slot_.resize(disks.robots, kNone);
  findPairs(disks, settings_.largest_move);
  WorkerTeam alone(1);
  run(disks, true, alone);
}

void SlidingContacts::run(const MovedDisks& disks, bool at_rest, WorkerTeam& team) {
  shifts_.clear();
  touches_.clear();
  double deepest = 0;
  for (const Pair& pair : pairs_) deepest = std::min(deepest, pair.gap);
  if (deepest >= -kSlack) {
    for (Pair& pair : pairs_) pair.normal_push = pair.tangent_push = 0;
    return;
  }
  // Others that the overlapping disks may be pushed against take part from the beginning.
  for (Pair& pair : pairs_) pair.selected = pair.gap < -deepest;
  do {
    formIslands(disks, at_rest);
    solveIslands(disks, team);
  } while (selectOverlapping(disks));
  report();
}

// The pairs with a gap below `reach`.
void SlidingContacts::findPairs(const MovedDisks& disks, double reach) {
  reach_ = reach;
  pairs_.clear();
  if (reach > settings_.largest_move) {
    searchPairs(disks, reach, reach);
    return;
  }
  if (close_at_.size() != disks.bodies->centre.size() ||
      anyMoved(disks.bodies->centre, close_at_, close_move_)) {
    listClosePairs(disks);
  }
  const double distance = 2 * settings_.radius + reach;
  for (const ClosePair close : close_) {
    const Vec centre = disks.to(close.first);
    if (isWall(close.second)) {
      const double gap = wallGap(close.second, centre);
      if (gap < reach) pairs_.push_back({.first = close.first, .second = close.second, .gap = gap});
      continue;
    }
    const Vec apart = difference(centre, disks.to(close.second));
    const double squared = dot(apart, apart);
    if (squared >= distance * distance) continue;
    pairs_.push_back({.first = close.first,
                      .second = close.second,
                      .gap = std::sqrt(squared) - 2 * settings_.radius});
  }
}

void SlidingContacts::listClosePairs(const MovedDisks& disks) {
  searchPairs(disks, settings_.largest_move + 2 * close_move_,
              settings_.largest_move + close_move_);
  close_.clear();
  for (const Pair& pair : pairs_) close_.push_back({pair.first, pair.second});
  close_at_ = disks.bodies->centre;
  pairs_.clear();
}

// Adds all pairs of disks with a gap below one limit, and robots with a gap to a wall below
// another.
void SlidingContacts::searchPairs(const MovedDisks& disks, double pair_gap, double wall_gap) {
  const double distance = 2 * settings_.radius + pair_gap;
  for (std::uint32_t i = 0; i < disks.robots; ++i) {
    const Vec centre = disks.to(i);
    const std::size_t begin = pairs_.size();
    for (const std::uint32_t j : disks.neighbours->of(i)) {
      if (j < i) continue;
      const Vec apart = difference(centre, disks.to(j));
      const double squared = dot(apart, apart);
      if (squared >= distance * distance) continue;
      pairs_.push_back({.first = i, .second = j, .gap = std::sqrt(squared) - 2 * settings_.radius});
    }
    if (pairs_.size() > begin + 1) {
      std::sort(pairs_.begin() + static_cast<std::ptrdiff_t>(begin), pairs_.end(),
                [](const Pair& a, const Pair& b) { return a.second < b.second; });
    }
    addWalls(i, centre, wall_gap);
  }
}

void SlidingContacts::addWalls(std::uint32_t robot, Vec centre, double reach) {
  const double near = settings_.radius + reach;
  if (centre.x >= near && centre.x <= settings_.arena.width - near && centre.y >= near &&
      centre.y <= settings_.arena.height - near) {
    return;
  }
  for (std::uint32_t wall = kFirstWall; wall < kNone; ++wall) {
    const double gap = wallGap(wall, centre);
    if (gap < reach) pairs_.push_back({.first = robot, .second = wall, .gap = gap});
  }
}

// Gives the pairs the pushes of other pairs, which are in the same order.
void SlidingContacts::takePushes(std::span<const Pair> pairs, double factor, bool select) {
  auto other = pairs.begin();
  for (Pair& pair : pairs_) {
    const auto isBefore = [&pair](const Pair& a) {
      return a.first != pair.first ? a.first < pair.first : a.second < pair.second;
    };
    while (other != pairs.end() && isBefore(*other)) ++other;
    if (other == pairs.end()) return;
    if (other->first != pair.first || other->second != pair.second) continue;
    pair.normal_push = factor * other->normal_push;
    pair.tangent_push = factor * other->tangent_push;
    pair.selected = select;
    pair.pressed = select ? other->pressed : true;
  }
}

std::uint32_t SlidingContacts::rootOf(std::uint32_t robot) {
  while (parent_[robot] != robot) {
    parent_[robot] = parent_[parent_[robot]];
    robot = parent_[robot];
  }
  return robot;
}

// Sorts the selected pairs by island, in the order of their first robots.
void SlidingContacts::formIslands(const MovedDisks& disks, bool at_rest) {
  for (const std::uint32_t robot : robot_index_) slot_[robot] = kNone;
  robot_index_.clear();
  islands_.clear();
  island_of_.clear();
  for (const Pair& pair : pairs_) {
    if (!pair.selected) continue;
    parent_[pair.first] = pair.first;
    if (pair.second < disks.robots) parent_[pair.second] = pair.second;
  }
  for (const Pair& pair : pairs_) {
    if (!pair.selected || pair.second >= disks.robots) continue;
    const std::uint32_t a = rootOf(pair.first);
    const std::uint32_t b = rootOf(pair.second);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  // Until the disks get their slots, the slot of a root is the number of its island.
  for (const Pair& pair : pairs_) {
    if (!pair.selected) continue;
    std::uint32_t& number = slot_[rootOf(pair.first)];
    if (number == kNone) {
      number = static_cast<std::uint32_t>(islands_.size());
      islands_.emplace_back();
    }
    ++islands_[number].contacts;
    island_of_.push_back(number);
  }
  std::size_t contacts = 0;
  for (Island& island : islands_) {
    island.first_contact = contacts;
    contacts += std::exchange(island.contacts, 0);
  }
  pair_index_.resize(contacts);
  std::size_t selected = 0;
  for (std::uint32_t p = 0; p < pairs_.size(); ++p) {
    if (!pairs_[p].selected) continue;
    Island& island = islands_[island_of_[selected++]];
    pair_index_[island.first_contact + island.contacts++] = p;
    slot_[rootOf(pairs_[p].first)] = kNone;
  }
  contacts_.clear();
  disks_.clear();
  for (Island& island : islands_) {
    island.first_disk = disks_.size();
    for (std::size_t c = 0; c < island.contacts; ++c) {
      addContact(pairs_[pair_index_[island.first_contact + c]], island, disks, at_rest);
    }
    island.disks = disks_.size() - island.first_disk;
  }
}

void SlidingContacts::addContact(const Pair& pair, const Island& island, const MovedDisks& disks,
                                 bool at_rest) {
  const auto first_disk = static_cast<std::uint32_t>(island.first_disk);
  DiskContact contact;
  contact.gap = pair.gap;
  contact.normal_push = pair.normal_push;
  contact.tangent_push = pair.tangent_push;
  contact.first = slotOf(pair.first, disks) - first_disk;
  Vec moved = difference(disks.to(pair.first), disks.from[pair.first]);
  double turned = at_rest ? 0 : disks.bodies->turned[pair.first];
  if (isWall(pair.second)) {
    contact.normal = wallNormal(pair.second);
  } else {
    const Vec apart = difference(disks.to(pair.first), disks.to(pair.second));
    const double distance = std::sqrt(dot(apart, apart));
    contact.normal = distance > 0 ? Vec{apart.x / distance, apart.y / distance}
                                  : disks.bodies->heading(pair.first);
    moved = difference(moved, difference(disks.to(pair.second), disks.from[pair.second]));
    if (pair.second < disks.robots) {
      contact.second = slotOf(pair.second, disks) - first_disk;
      turned += at_rest ? 0 : disks.bodies->turned[pair.second];
    } else {
      contact.gap = std::max(contact.gap, -settings_.largest_move);
      contact.most_push = most_push_;
    }
  }
  const Vec tangent = {-contact.normal.y, contact.normal.x};
  contact.slide = dot(tangent, moved) - settings_.radius * turned;
  contacts_.push_back(contact);
}

// The index of a robot in disks_.
std::uint32_t SlidingContacts::slotOf(std::uint32_t robot, const MovedDisks& disks) {
  if (slot_[robot] == kNone) {
    slot_[robot] = static_cast<std::uint32_t>(disks_.size());
    disks_.push_back({disks.bodies->heading(robot), {}, 0});
    robot_index_.push_back(robot);
  }
  return slot_[robot];
}

// Islands do not depend on each other. Threads take them in runs of some hundred contacts.
void SlidingContacts::solveIslands(const MovedDisks& disks, WorkerTeam& team) {
  solvers_.resize(team.size(), solvers_.front());
  runs_.assign(1, 0);
  std::size_t contacts = 0;
  for (std::size_t k = 0; k < islands_.size(); ++k) {
    contacts += islands_[k].contacts;
    if (contacts < kContactsOfARun && k + 1 < islands_.size()) continue;
    runs_.push_back(k + 1);
    contacts = 0;
  }
  team.run(runs_.size() - 1, [&](std::size_t run, std::size_t worker) {
    for (std::size_t k = runs_[run]; k < runs_[run + 1]; ++k) {
      solve(disks, islands_[k], solvers_[worker]);
    }
  });
  for (const Island& island : islands_) {
    if (island.sweeps == 0) continue;
    ++all_islands_;
    sweeps_ += island.sweeps;
    unsolved_islands_ += island.sweeps == ContactSolver::kMostSweeps ? 1 : 0;
  }
}

void SlidingContacts::solve(const MovedDisks& disks, Island& island, ContactSolver& solver) {
  const auto contacts = std::span(contacts_).subspan(island.first_contact, island.contacts);
  const bool overlaps = std::ranges::any_of(
      contacts, [](const DiskContact& contact) { return contact.gap < -kSlack; });
  if (!overlaps) {
    for (DiskContact& contact : contacts) contact.normal_push = contact.tangent_push = 0;
    return;
  }
  const auto island_disks = std::span(disks_).subspan(island.first_disk, island.disks);
  island.sweeps = solver.solve(island_disks, contacts);
  const bool far = std::ranges::any_of(island_disks, [&](const ContactDisk& disk) {
    return dot(disk.shift, disk.shift) > squaredFarthestShift();
  });
  if (far || island.sweeps == ContactSolver::kMostSweeps) limit(disks, island);
}

// Shortens the moves of an island until nothing overlaps that did not overlap before.
void SlidingContacts::limit(const MovedDisks& disks, const Island& island) {
  double share = 1;
  for (int halving = 0; halving <= kMostHalvings; ++halving, share /= 2) {
    if (halving == kMostHalvings) share = 0;
    const auto place = [&](std::uint32_t disk) {
      const Vec from = disks.from[disk];
      const Vec move = difference(shifted(disks, disk), from);
      return Vec{from.x + share * move.x, from.y + share * move.y};
    };
    bool fits = true;
    for (std::size_t c = 0; c < island.contacts && fits; ++c) {
      const Pair& pair = pairs_[pair_index_[island.first_contact + c]];
      if (!isWall(pair.second) && pair.second >= disks.robots) continue;
      const Vec second = isWall(pair.second) ? Vec{} : place(pair.second);
      fits = gapOf(pair, place(pair.first), second) >= -kSlack;
    }
    for (std::size_t d = island.first_disk; d < island.first_disk + island.disks && fits; ++d) {
      const Vec shift = difference(place(robot_index_[d]), disks.to(robot_index_[d]));
      fits = dot(shift, shift) <= squaredFarthestShift();
    }
    if (fits || share == 0) break;
  }
  for (std::size_t d = island.first_disk; d < island.first_disk + island.disks; ++d) {
    const std::uint32_t robot = robot_index_[d];
    const Vec from = disks.from[robot];
    const Vec move = difference(shifted(disks, robot), from);
    disks_[d].shift =
        difference({from.x + share * move.x, from.y + share * move.y}, disks.to(robot));
    disks_[d].roll *= share;
  }
}

// Selects pairs that overlap now. Pushes found so far remain as guesses.
bool SlidingContacts::selectOverlapping(const MovedDisks& disks) {
  double farthest = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Pair& pair = pairs_[pair_index_[c]];
    pair.normal_push = contacts_[c].normal_push;
    pair.tangent_push = contacts_[c].tangent_push;
  }
  for (const ContactDisk& disk : disks_) {
    farthest = std::max(farthest, dot(disk.shift, disk.shift));
  }
  if (4 * farthest > reach_ * reach_) {
    // Disks may overlap that were not close after the free motion.
    std::vector<Pair> selected;
    for (const Pair& pair : pairs_) {
      if (pair.selected) selected.push_back(pair);
    }
    findPairs(disks, kFarthestGap * settings_.largest_move);
    takePushes(selected, 1, true);
  }
  bool any = false;
  for (Pair& pair : pairs_) {
    if (pair.selected) continue;
    if (slot_[pair.first] == kNone &&
        (pair.second >= disks.robots || slot_[pair.second] == kNone)) {
      continue;
    }
    const Vec second = isWall(pair.second) ? Vec{} : shifted(disks, pair.second);
    if (gapOf(pair, shifted(disks, pair.first), second) >= -kSlack) continue;
    pair.selected = true;
    any = true;
  }
  return any;
}

void SlidingContacts::report() {
  for (std::size_t d = 0; d < disks_.size(); ++d) {
    const ContactDisk& disk = disks_[d];
    if (disk.shift.x == 0 && disk.shift.y == 0 && disk.roll == 0) continue;
    shifts_.push_back({robot_index_[d], disk.shift, disk.roll / settings_.radius});
  }
  for (Pair& pair : pairs_) {
    if (!pair.selected) pair.normal_push = pair.tangent_push = 0;
    if (pair.normal_push > 0) {
      touches_.push_back(
          {pair.first, isWall(pair.second) ? Touch::kWall : pair.second, !pair.pressed});
    }
  }
}

double SlidingContacts::gapOf(const Pair& pair, Vec first, Vec second) const {
  if (isWall(pair.second)) return wallGap(pair.second, first);
  const Vec apart = difference(first, second);
  return std::sqrt(dot(apart, apart)) - 2 * settings_.radius;
}

double SlidingContacts::wallGap(std::uint32_t wall, Vec centre) const {
  switch (wall - kFirstWall) {
    case 0:
      return centre.x - settings_.radius;
    case 1:
      return settings_.arena.width - centre.x - settings_.radius;
    case 2:
      return centre.y - settings_.radius;
    default:
      return settings_.arena.height - centre.y - settings_.radius;
  }
}

Vec SlidingContacts::shifted(const MovedDisks& disks, std::uint32_t disk) const {
  if (disk >= disks.robots || slot_[disk] == kNone) return disks.to(disk);
  return sum(disks.to(disk), disks_[slot_[disk]].shift);
}

double SlidingContacts::squaredFarthestShift() const {
  const double farthest = kFarthestGap / 2 * settings_.largest_move;
  return farthest * farthest;
}

}  // namespace lab::sim
