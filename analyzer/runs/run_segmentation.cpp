#include "analyzer/runs/run_segmentation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lab::analysis {
namespace {

constexpr double kShortestStop = 0.6;        // shortest stop, in tumbles
constexpr std::size_t kLongestStretch = 64;  // bins; longer stretches are concatenated
// Log likelihood (nats) that a change point must gain. The values hardly matter, because stops are
// long compared with the noise; stops that are split by mistake are merged again later.
constexpr double kChange = 3;
constexpr double kBetweenStops = 4;
constexpr double kChain = 12;
constexpr double kHopeless = 80;

struct Node {
  double cost = std::numeric_limits<double>::infinity();
  std::size_t begin = 0;  ///< Of the last stretch.
  bool before = false;    ///< The stretch before it is a run.
};

using Nodes = std::array<Node, 2>;  // by whether the last stretch is a run

void relax(Node& node, const Nodes& from, std::size_t begin, double cost, bool run) {
  for (const bool before : {false, true}) {
    double change = kChange;
    if (begin == 0) {
      change = 0;
    } else if (before == run) {
      change = run ? kChain : kBetweenStops;
    }
    const double total = from[before ? 1 : 0].cost + cost + change;
    if (total < node.cost) {
      node = {total, begin, before};
    }
  }
}

}  // namespace

void StretchSums::add(const TrackBin& bin, const TrackBin& origin) {
  const double n = bin.frames;
  const double t = bin.time - origin.time;
  const double dx = bin.x - origin.x;
  const double dy = bin.y - origin.y;
  w += n;
  u += n * t;
  uu += n * t * t;
  x += n * dx;
  y += n * dy;
  q += n * (dx * dx + dy * dy);
  ux += n * t * dx;
  uy += n * t * dy;
}

std::vector<Stretch> segmentMotion(std::span<const TrackBin> bins, const MotionScales& scales) {
  const std::size_t n = bins.size();
  const double nats = 0.5 / (scales.sigma * scales.sigma);
  const double v = scales.speed;
  std::vector<Nodes> nodes(n + 1);
  nodes[0] = {Node{0, 0, false}, Node{0, 0, true}};
  for (std::size_t end = 1; end <= n; ++end) {
    const TrackBin& last = bins[end - 1];
    const std::size_t furthest = end > kLongestStretch ? end - kLongestStretch : 0;
    StretchSums sums;
    for (std::size_t begin = end; begin-- > furthest;) {
      sums.add(bins[begin], last);
      const double stop = nats * std::max(0.0, sums.place2());
      // The best straight line at speed v.
      const double drift = std::sqrt(sums.driftX() * sums.driftX() + sums.driftY() * sums.driftY());
      const double run = stop + nats * (v * v * sums.time2() - 2 * v * drift);
      const double lasted = last.time - bins[begin].time + scales.period;
      if (lasted >= kShortestStop * scales.tumble || begin == 0 || end == n) {
        relax(nodes[end][0], nodes[begin], begin, stop, false);
      }
      relax(nodes[end][1], nodes[begin], begin, run, true);
      if (std::min(stop, run) > kHopeless) {
        break;
      }
    }
  }

  std::vector<Stretch> stretches;
  bool run = n > 0 && nodes[n][1].cost < nodes[n][0].cost;
  for (std::size_t end = n; end > 0;) {
    const Node& node = nodes[end][run ? 1 : 0];
    if (run && !stretches.empty() && stretches.back().run) {
      stretches.back().begin = node.begin;
    } else {
      stretches.push_back({run, node.begin, end});
    }
    end = node.begin;
    run = node.before;
  }
  std::reverse(stretches.begin(), stretches.end());
  return stretches;
}

}  // namespace lab::analysis
