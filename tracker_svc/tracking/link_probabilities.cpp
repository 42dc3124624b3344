#include "tracker_svc/tracking/link_probabilities.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace lab::tracker {
namespace {

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

void LinkProbabilities::group(std::span<const Link> links) {
  std::vector<std::size_t> parents(links.size());
  for (std::size_t i = 0; i < parents.size(); ++i) parents[i] = i;
  const auto root = [&](std::size_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
  };
  std::map<std::size_t, std::size_t> of_track;
  std::map<std::size_t, std::size_t> of_detection;
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (const std::size_t other :
         {of_track.try_emplace(links[i].track, i).first->second,
          of_detection.try_emplace(links[i].detection, i).first->second}) {
      const std::size_t a = root(i);
      const std::size_t b = root(other);
      parents[std::max(a, b)] = std::min(a, b);
    }
  }
  std::map<std::size_t, std::size_t> place;
  groups_.clear();
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto [at, is_new] = place.try_emplace(root(i), groups_.size());
    if (is_new) groups_.emplace_back();
    groups_[at->second].push_back(i);
  }
}

/// Sums over all assignments, row by row, by the set of columns that are taken.
void LinkProbabilities::solveExactly(std::span<const Link> links,
                                     const std::vector<std::size_t>& group) {
  const Table table(links, group);
  if (table.columns > kExact) return propagate(links, group);
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

void LinkProbabilities::propagate(std::span<const Link> links,
                                  const std::vector<std::size_t>& group) {
  constexpr int kRounds = 200;
  constexpr double kSettled = 1e-6;
  const Table table(links, group);
  // By link: the message of its column, and that of its row.
  std::vector<double> from_column(links.size(), 1);
  std::vector<double> from_row(links.size(), 0);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> sums(table.columns, 1);
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      double sum = table.alone[r];
      for (const Table::Entry& entry : table.rows[r]) sum += entry.weight * from_column[entry.link];
      for (const Table::Entry& entry : table.rows[r]) {
        const double others = sum - entry.weight * from_column[entry.link];
        from_row[entry.link] = entry.weight / std::max(others, 1e-300);
        sums[entry.column] += from_row[entry.link];
      }
    }
    double change = 0;
    for (const std::vector<Table::Entry>& row : table.rows) {
      for (const Table::Entry& entry : row) {
        const double now = 1 / std::max(sums[entry.column] - from_row[entry.link], 1.0);
        change = std::max(change, std::abs(now - from_column[entry.link]));
        from_column[entry.link] = now;
      }
    }
    if (change < kSettled) break;
  }
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    double sum = table.alone[r];
    for (const Table::Entry& entry : table.rows[r]) sum += entry.weight * from_column[entry.link];
    for (const Table::Entry& entry : table.rows[r]) {
      probabilities_[entry.link] = entry.weight * from_column[entry.link] / sum;
    }
  }
}

}  // namespace lab::tracker
