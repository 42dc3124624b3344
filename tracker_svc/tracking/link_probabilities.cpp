#include "tracker_svc/tracking/link_probabilities.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace lab::tracker {
namespace {

// [1] strength of a link, relative to the best of its track and of its detection, that is left out
constexpr double kNegligible = 1e-7;

/// The place of a number among sorted different numbers.
std::size_t placeOf(const std::vector<std::size_t>& numbers, std::size_t number) {
  return static_cast<std::size_t>(std::lower_bound(numbers.begin(), numbers.end(), number) -
                                  numbers.begin());
}

std::vector<std::size_t> different(std::vector<std::size_t> numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

/// Links of a group between rows and columns, the fewer ones being columns.
struct Table {
  struct Entry {
    std::size_t link;
    std::size_t column;
    double weight;
  };
  std::vector<std::vector<Entry>> rows;
  std::vector<double> alone;  ///< weight of a row without a link
  std::size_t columns = 0;

  Table(std::span<const Link> links, const std::vector<std::size_t>& group) {
    std::vector<std::size_t> tracks;
    std::vector<std::size_t> detections;
    for (const std::size_t i : group) {
      tracks.push_back(links[i].track);
      detections.push_back(links[i].detection);
    }
    tracks = different(std::move(tracks));
    detections = different(std::move(detections));
    const bool swapped = tracks.size() < detections.size();
    columns = std::min(tracks.size(), detections.size());
    rows.resize(std::max(tracks.size(), detections.size()));
    for (const std::size_t i : group) {
      const std::size_t track = placeOf(tracks, links[i].track);
      const std::size_t detection = placeOf(detections, links[i].detection);
      rows[swapped ? detection : track].push_back(
          {i, swapped ? track : detection, links[i].weight});
    }
    // The largest weight of a row becomes 1: products stay finite.
    for (std::vector<Entry>& row : rows) {
      double most = 1;
      for (const Entry& entry : row) most = std::max(most, entry.weight);
      for (Entry& entry : row) entry.weight /= most;
      alone.push_back(1 / most);
    }
  }
};

}  // namespace

const std::vector<double>& LinkProbabilities::of(std::span<const Link> links) {
  probabilities_.assign(links.size(), 0);
  group(links);
  for (const std::vector<std::size_t>& group : groups_) {
    if (group.size() == 1) {
      const double weight = links[group.front()].weight;
      probabilities_[group.front()] = std::isinf(weight) ? 1 : weight / (1 + weight);
    } else {
      solveExactly(links, group);
    }
  }
  return probabilities_;
}

/// Joins links to groups, the strongest first, as long as the groups stay small.
void LinkProbabilities::group(std::span<const Link> links) {
  std::size_t tracks = 0;
  std::size_t detections = 0;
  for (const Link& link : links) {
    tracks = std::max(tracks, link.track + 1);
    detections = std::max(detections, link.detection + 1);
  }
  std::vector<double> best_track(tracks, 0);
  std::vector<double> best_detection(detections, 0);
  for (const Link& link : links) {
    best_track[link.track] = std::max(best_track[link.track], link.weight);
    best_detection[link.detection] = std::max(best_detection[link.detection], link.weight);
  }
  const auto strength = [&](std::size_t i) {
    const Link& link = links[i];
    const double track = link.weight / std::max(1.0, best_track[link.track]);
    const double detection = link.weight / std::max(1.0, best_detection[link.detection]);
    return track * detection;
  };
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < links.size(); ++i) order.emplace_back(-strength(i), i);
  std::sort(order.begin(), order.end());

  // Nodes: tracks, then detections.
  struct Node {
    std::size_t parent;
    std::size_t tracks;
    std::size_t detections;
  };
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < tracks; ++i) nodes.push_back({i, 1, 0});
  for (std::size_t i = 0; i < detections; ++i) nodes.push_back({tracks + i, 0, 1});
  const auto root = [&](std::size_t i) {
    while (nodes[i].parent != i) i = nodes[i].parent = nodes[nodes[i].parent].parent;
    return i;
  };
  for (const auto& [minus, i] : order) {
    if (-minus < kNegligible) break;
    const std::size_t a = root(links[i].track);
    const std::size_t b = root(tracks + links[i].detection);
    if (a == b) continue;
    const std::size_t both_tracks = nodes[a].tracks + nodes[b].tracks;
    const std::size_t both_detections = nodes[a].detections + nodes[b].detections;
    if (std::min(both_tracks, both_detections) > kMost ||
        std::max(both_tracks, both_detections) > 4 * kMost) {
      continue;
    }
    nodes[std::max(a, b)].parent = std::min(a, b);
    nodes[std::min(a, b)].tracks = both_tracks;
    nodes[std::min(a, b)].detections = both_detections;
  }
  std::map<std::size_t, std::size_t> place;
  groups_.clear();
  for (std::size_t i = 0; i < links.size(); ++i) {
    const std::size_t own = root(links[i].track);
    if (own != root(tracks + links[i].detection)) continue;
    const auto [at, is_new] = place.try_emplace(own, groups_.size());
    if (is_new) groups_.emplace_back();
    groups_[at->second].push_back(i);
  }
}

/// Sums over all assignments, row by row, by the set of columns that are taken.
void LinkProbabilities::solveExactly(std::span<const Link> links,
                                     const std::vector<std::size_t>& group) {
  const Table table(links, group);
  const std::size_t sets = std::size_t{1} << table.columns;
  // after[r][set]: sum over the rows from r on, if the columns of the set are taken.
  std::vector<std::vector<double>> after(table.rows.size() + 1, std::vector<double>(sets, 1));
  for (std::size_t r = table.rows.size(); r-- > 0;) {
    for (std::size_t set = 0; set < sets; ++set) {
      double sum = table.alone[r] * after[r + 1][set];
      for (const Table::Entry& entry : table.rows[r]) {
        const std::size_t bit = std::size_t{1} << entry.column;
        if ((set & bit) == 0) sum += entry.weight * after[r + 1][set | bit];
      }
      after[r][set] = sum;
    }
  }
  std::vector<double> before(sets, 0);
  std::vector<double> next(sets);
  before[0] = 1;
  const double all = after[0][0];
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    std::fill(next.begin(), next.end(), 0.0);
    for (std::size_t set = 0; set < sets; ++set) {
      if (before[set] == 0) continue;
      next[set] += table.alone[r] * before[set];
      for (const Table::Entry& entry : table.rows[r]) {
        const std::size_t bit = std::size_t{1} << entry.column;
        if ((set & bit) != 0) continue;
        const double here = entry.weight * before[set];
        next[set | bit] += here;
        probabilities_[entry.link] += here * after[r + 1][set | bit] / all;
      }
    }
    before.swap(next);
  }
}

}  // namespace lab::tracker
