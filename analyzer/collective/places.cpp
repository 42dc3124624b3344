#include "analyzer/collective/places.hpp"

#include <cmath>

namespace lab::collective {

bool Region::contains(double px, double py) const {
  const double dx = px - x;
  const double dy = py - y;
  if (circle) return dx * dx + dy * dy <= radius * radius;
  return std::abs(dx) <= 0.5 * width && std::abs(dy) <= 0.5 * height;
}

PlaceTracker::Change PlaceTracker::take(double time, int robot, int place) {
  State& state = robots_[robot];
  if (place < 0) return {state.place, state.place};
  if (state.place < 0) {
    state.place = place;
    return {-1, place};
  }
  if (place == state.place) {
    state.candidate = -1;
    return {place, place};
  }
  if (place != state.candidate || time < state.since) {
    state.candidate = place;
    state.since = time;
  }
  const int before = state.place;
  if (time - state.since >= confirm_) {
    state.place = place;
    state.candidate = -1;
  }
  return {before, state.place};
}

}  // namespace lab::collective
