#include "runner/campaign/adaptive/expected_reduction.hpp"

#include <cmath>
#include <optional>

namespace lab::runner::campaign {
namespace {

constexpr double kSameScore = 1e-9;  // relative difference that counts as none

struct Scored {
  ChosenRun run;
  double score = 0;

  /// Rounding must not decide between candidates that are equally good.
  [[nodiscard]] bool isBetterThan(const Scored& other) const {
    if (std::abs(score - other.score) > kSameScore * other.score) return score > other.score;
    return run.reduction > other.run.reduction * (1 + kSameScore);
  }
};

}  // namespace

Eigen::VectorXd expectedReductions(const GaussianDesign& design) {
  const Eigen::VectorXd total = design.candidates.diagonal() + design.noise;
  const Eigen::VectorXd squares = design.cross.cwiseAbs2().transpose() * design.weights;
  return (total.array() > 0).select(squares.array() / total.array(), 0.0);
}

void condition(GaussianDesign& design, Eigen::Index candidate) {
  const double total = design.candidates(candidate, candidate) + design.noise(candidate);
  if (!(total > 0)) return;
  const Eigen::VectorXd with_targets = design.cross.col(candidate);
  const Eigen::VectorXd with_candidates = design.candidates.col(candidate);
  design.variances -= with_targets.cwiseAbs2() / total;
  design.cross -= with_targets * with_candidates.transpose() / total;
  design.candidates -= with_candidates * with_candidates.transpose() / total;
}

std::vector<ChosenRun> chooseRuns(GaussianDesign& design, Choices choices) {
  std::vector<ChosenRun> chosen;
  while (chosen.size() < choices.count) {
    const Eigen::VectorXd reductions = expectedReductions(design);
    std::optional<Scored> best;
    for (std::size_t i = 0; i < choices.costs.size(); ++i) {
      if (choices.left[i] <= 0 || choices.costs[i] > choices.time_left) continue;
      const double reduction = reductions(static_cast<Eigen::Index>(i));
      const Scored scored{{i, reduction}, reduction / choices.costs[i]};
      if (!best || scored.isBetterThan(*best)) best = scored;
    }
    if (!best) break;
    const std::size_t candidate = best->run.candidate;
    chosen.push_back(best->run);
    --choices.left[candidate];
    choices.time_left -= choices.costs[candidate];
    condition(design, static_cast<Eigen::Index>(candidate));
  }
  return chosen;
}

}  // namespace lab::runner::campaign
