#include "sim_svc/world/contact_solver.hpp"

#include <algorithm>
#include <cmath>

namespace lab::sim {
namespace {

double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y; }

// The tangent of a contact: its normal turned by +90 degrees.
Vec turned(Vec v) { return {-v.y, v.x}; }

// The displacement of a disk by a push of 1.
Vec responseOf(const ContactDisk& disk, double across, Vec push) {
  const double along = (1 - across) * dot(disk.heading, push);
  return {across * push.x + along * disk.heading.x, across * push.y + along * disk.heading.y};
}

struct Push {
  double normal = 0;
  double tangent = 0;
};

// What the motion of all other contacts leaves at one contact.
struct Remaining {
  double gap = 0;
  double slide = 0;
};

}  // namespace

ContactSolver::Row ContactSolver::rowOf(const DiskContact& contact,
                                        std::span<const ContactDisk> disks) const {
  const Vec normal = contact.normal;
  const Vec tangent = turned(normal);
  Row row;
  row.first_normal = responseOf(disks[contact.first], mobility_.across, normal);
  row.first_tangent = responseOf(disks[contact.first], mobility_.across, tangent);
  row.tt = mobility_.turn;
  if (contact.second != DiskContact::kFixed) {
    row.second_normal = responseOf(disks[contact.second], mobility_.across, normal);
    row.second_tangent = responseOf(disks[contact.second], mobility_.across, tangent);
    row.tt += mobility_.turn;
  }
  row.nn = dot(normal, row.first_normal) + dot(normal, row.second_normal);
  row.nt = dot(normal, row.first_tangent) + dot(normal, row.second_tangent);
  row.tt += dot(tangent, row.first_tangent) + dot(tangent, row.second_tangent);
  return row;
}

void ContactSolver::apply(const Row& row, const DiskContact& contact, double normal, double tangent,
                          std::span<ContactDisk> disks) const {
  ContactDisk& first = disks[contact.first];
  first.shift.x += normal * row.first_normal.x + tangent * row.first_tangent.x;
  first.shift.y += normal * row.first_normal.y + tangent * row.first_tangent.y;
  first.roll -= tangent * mobility_.turn;
  if (contact.second == DiskContact::kFixed) return;
  ContactDisk& second = disks[contact.second];
  second.shift.x -= normal * row.second_normal.x + tangent * row.second_tangent.x;
  second.shift.y -= normal * row.second_normal.y + tangent * row.second_tangent.y;
  second.roll -= tangent * mobility_.turn;
}

namespace {

// The pushes of a contact that slides, with a tangential push of `friction` times the normal one.
// Returns false if the rims would slide with the friction instead of against it.
template <class Row>
bool slides(const Row& row, Remaining free, double friction, Push& push) {
  const double per_normal = row.nn + friction * row.nt;
  if (per_normal <= 0) return false;
  push.normal = -free.gap / per_normal;
  push.tangent = friction * push.normal;
  const double slid = free.slide + row.nt * push.normal + row.tt * push.tangent;
  return friction > 0 ? slid <= 0 : slid >= 0;
}

// The pushes of one contact by Coulomb's law: open, rolling, or sliding in either direction.
template <class Row>
Push coulombPush(const Row& row, Remaining free, double friction, double most) {
  if (free.gap >= 0) return {};
  Push push;
  const double determinant = row.nn * row.tt - row.nt * row.nt;
  push.normal = (row.nt * free.slide - row.tt * free.gap) / determinant;
  push.tangent = (row.nt * free.gap - row.nn * free.slide) / determinant;
  if (push.normal < 0 || std::fabs(push.tangent) > friction * push.normal) {
    const double against = push.tangent < 0 ? -friction : friction;
    if (!slides(row, free, against, push) && !slides(row, free, -against, push)) {
      // No exact solution: a robot can wedge itself. Without overlap, with all friction.
      push.normal = -free.gap / row.nn;
      push.tangent = against * push.normal;
    }
  }
  if (push.normal > most) {
    push.normal = most;
    const double rolling = -(free.slide + row.nt * most) / row.tt;
    push.tangent = std::clamp(rolling, -friction * most, friction * most);
  }
  return push;
}

// One step towards the pushes of a contact whose friction has a known limit.
template <class Row>
Push limitedPush(const Row& row, Remaining free, double most_tangent, double most, double tangent) {
  Push push;
  push.normal = std::clamp(-(free.gap + row.nt * tangent) / row.nn, 0.0, most);
  const double rolling = -(free.slide + row.nt * push.normal) / row.tt;
  push.tangent = std::clamp(rolling, -most_tangent, most_tangent);
  return push;
}

double linearGap(const DiskContact& contact, std::span<const ContactDisk> disks) {
  double gap = contact.gap + dot(contact.normal, disks[contact.first].shift);
  if (contact.second != DiskContact::kFixed) {
    gap -= dot(contact.normal, disks[contact.second].shift);
  }
  return gap;
}

}  // namespace

int ContactSolver::solve(std::span<ContactDisk> disks, std::span<DiskContact> contacts) {
  const bool isotropic = mobility_.across == 1;
  rows_.clear();
  for (const DiskContact& contact : contacts) {
    const bool pushed = contact.normal_push != 0 || contact.tangent_push != 0;
    if (isotropic && !pushed) continue;
    const Row row = rowOf(contact, disks);
    if (!isotropic) rows_.push_back(row);
    if (pushed) apply(row, contact, contact.normal_push, contact.tangent_push, disks);
  }
  most_tangent_.clear();
  before_.clear();
  momentum_ = 1;
  for (int sweep = 1; sweep <= kMostSweeps; ++sweep) {
    if (sweep == kCoulombSweeps && friction_ > 0) {
      for (const DiskContact& contact : contacts) {
        most_tangent_.push_back(friction_ * contact.normal_push);
      }
    }
    const double change = isotropic ? sweepIsotropic(disks, contacts) : sweepRows(disks, contacts);
    if (contacts.size() == 1) return sweep;
    if (change > kTolerance) {
      accelerate(disks, contacts);
      continue;
    }
    const bool overlaps = std::ranges::any_of(contacts, [&](const DiskContact& contact) {
      return contact.normal_push < contact.most_push && linearGap(contact, disks) < -kMostOverlap;
    });
    if (!overlaps) return sweep;
  }
  return kMostSweeps;
}

// Moves on in the direction of the last two sweeps (Nesterov's momentum). Starts anew when the
// sweeps turn back (O'Donoghue and Candes, Found. Comput. Math. 15, 2015).
void ContactSolver::accelerate(std::span<ContactDisk> disks, std::span<DiskContact> contacts) {
  now_.clear();
  for (const ContactDisk& disk : disks) {
    now_.insert(now_.end(), {disk.shift.x, disk.shift.y, disk.roll});
  }
  for (const DiskContact& contact : contacts) {
    now_.insert(now_.end(), {contact.normal_push, contact.tangent_push});
  }
  if (before_.empty()) {
    before_ = now_;
    extrapolated_ = now_;
    return;
  }
  double back = 0;
  for (std::size_t k = 3 * disks.size(); k < now_.size(); ++k) {
    back += (extrapolated_[k] - now_[k]) * (now_[k] - before_[k]);
  }
  if (back > 0) momentum_ = 1;
  const double next = (1 + std::sqrt(1 + 4 * momentum_ * momentum_)) / 2;
  const double factor = (momentum_ - 1) / next;
  momentum_ = next;
  for (std::size_t k = 0; k < now_.size(); ++k) {
    extrapolated_[k] = now_[k] + factor * (now_[k] - before_[k]);
  }
  before_.swap(now_);
  const double* value = extrapolated_.data();
  for (ContactDisk& disk : disks) {
    disk.shift = {value[0], value[1]};
    disk.roll = value[2];
    value += 3;
  }
  for (DiskContact& contact : contacts) {
    contact.normal_push = value[0];
    contact.tangent_push = value[1];
    value += 2;
  }
}

// With the same mobility in all directions, normal and tangential pushes do not interact: each has
// its own equation, and the matrices are those of one or two free disks.
double ContactSolver::sweepIsotropic(std::span<ContactDisk> disks,
                                     std::span<DiskContact> contacts) const {
  const double turn = mobility_.turn;
  const double one_tt = 1 / (1 + turn);
  double change = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    DiskContact& contact = contacts[c];
    ContactDisk& first = disks[contact.first];
    ContactDisk* second = contact.second == DiskContact::kFixed ? nullptr : &disks[contact.second];
    Vec apart = first.shift;
    double roll = first.roll;
    double share = 1;  // of a displacement that the first disk takes
    if (second != nullptr) {
      apart = {apart.x - second->shift.x, apart.y - second->shift.y};
      roll += second->roll;
      share = 0.5;
    }
    const Vec n = contact.normal;
    const double gap = contact.gap + n.x * apart.x + n.y * apart.y;
    if (gap >= 0 && contact.normal_push == 0 && contact.tangent_push == 0) continue;
    const double slide = contact.slide + n.x * apart.y - n.y * apart.x - roll;
    const double push = std::clamp(contact.normal_push - share * gap, 0.0, contact.most_push);
    const double limit = most_tangent_.empty() ? friction_ * push : most_tangent_[c];
    const double drag = std::clamp(contact.tangent_push - share * one_tt * slide, -limit, limit);
    const double normal = push - contact.normal_push;
    const double tangent = drag - contact.tangent_push;
    contact.normal_push = push;
    contact.tangent_push = drag;
    const Vec move = {normal * n.x - tangent * n.y, normal * n.y + tangent * n.x};
    first.shift = {first.shift.x + move.x, first.shift.y + move.y};
    first.roll -= tangent * turn;
    if (second != nullptr) {
      second->shift = {second->shift.x - move.x, second->shift.y - move.y};
      second->roll -= tangent * turn;
    }
    change = std::max({change, std::fabs(normal) / share, std::fabs(tangent) / (share * one_tt)});
  }
  return change;
}

double ContactSolver::sweepRows(std::span<ContactDisk> disks,
                                std::span<DiskContact> contacts) const {
  double change = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    DiskContact& contact = contacts[c];
    const double gap = linearGap(contact, disks);
    if (gap >= 0 && contact.normal_push == 0 && contact.tangent_push == 0) continue;
    const Row& row = rows_[c];
    Push push;
    if (friction_ == 0) {
      push.normal = std::clamp(contact.normal_push - gap / row.nn, 0.0, contact.most_push);
    } else {
      const ContactDisk& first = disks[contact.first];
      const Vec tangent = turned(contact.normal);
      double slide = contact.slide + dot(tangent, first.shift) - first.roll;
      if (contact.second != DiskContact::kFixed) {
        const ContactDisk& second = disks[contact.second];
        slide -= dot(tangent, second.shift) + second.roll;
      }
      const Remaining free = {gap - row.nn * contact.normal_push - row.nt * contact.tangent_push,
                              slide - row.nt * contact.normal_push - row.tt * contact.tangent_push};
      push = most_tangent_.empty() ? coulombPush(row, free, friction_, contact.most_push)
                                   : limitedPush(row, free, most_tangent_[c], contact.most_push,
                                                 contact.tangent_push);
    }
    const double normal = push.normal - contact.normal_push;
    const double tangent = push.tangent - contact.tangent_push;
    if (normal == 0 && tangent == 0) continue;
    contact.normal_push = push.normal;
    contact.tangent_push = push.tangent;
    apply(row, contact, normal, tangent, disks);
    change = std::max({change, std::fabs(normal) * row.nn, std::fabs(tangent) * row.tt});
  }
  return change;
}

}  // namespace lab::sim
