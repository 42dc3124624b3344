#include "common/experiment/keys/sweep_keys.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/keys/key_helpers.hpp"
#include "common/experiment/keys/toml_reader.hpp"
#include "common/files/experiment_error.hpp"
#include "common/files/file_problems.hpp"
#include "common/files/toml_document.hpp"

namespace lab {
namespace keys {
namespace {

const std::array<Choice, 2> kSamplings = {
    {choiceOf("latin", Sampling::kLatin), choiceOf("sobol", Sampling::kSobol)}};

const std::array<Choice, 3> kGoals = {{choiceOf("mean", AdaptiveGoal::kMean),
                                       choiceOf("law", AdaptiveGoal::kLaw),
                                       choiceOf("boundary", AdaptiveGoal::kBoundary)}};

/// A key that is read, and not part of the experiment of a run.
Key ofCampaign(Key key) {
  key.need = Need::kShorthand;
  return key;
}

void visitAdaptive(KeyVisitor& v, AdaptivePlan& plan) {
  const Selector goal(v,
                      ofCampaign({"goal",
                                  "what shall be known; mean: the quantity at all points; law: its "
                                  "power law in the swept keys; boundary: where it crosses a level "
                                  "along the first swept key"}),
                      kGoals, plan.goal);
  v.text({.name = "quantity",
          .meaning = "an estimate: a column of campaign.csv, as \"D_r_rad2_s\"",
          .need = Need::kRequired},
         {.most = 200}, plan.quantity);
  v.text(ofCampaign({.name = "parameter",
                     .meaning = "of a law: exponents, prefactor, curve (its values at all points), "
                                "or a swept key, whose exponent is meant; if empty, exponents",
                     .default_text = "empty"}),
         {.most = 200}, plan.parameter);
  v.flag(ofCampaign({"relative",
                     "of a mean: relative errors count, for positive quantities of "
                     "different sizes; false: absolute ones"}),
         plan.relative);
  v.number(goal.only({AdaptiveGoal::kBoundary},
                     ofCampaign({"level", "the value that the quantity crosses, in its unit"})),
           {-1e12, 1e12}, plan.level);
  v.number(ofCampaign({"robot_time_s", "time of all runs, at most; 0: no limit"}), {0, 1e9},
           plan.robot_time_s);
  v.number(ofCampaign({"error",
                       "the campaign ends at this standard error of the goal, which campaigns.md "
                       "defines; 0: no such rule"}),
           {0, 1e12}, plan.error);
  v.integer(ofCampaign({"runs_per_round", "runs that are chosen together, and run side by side"}),
            1, 1000, plan.runs_per_round);
  v.number(ofCampaign({"between_runs_s", "robot time that a run takes beside its duration"}),
           {0, 86400}, plan.between_runs_s);
}

}  // namespace

void visitSweep(KeyVisitor& v, SweepTable& sweep) {
  v.texts(ofCampaign({.name = "over",
                      .meaning = "swept keys with their values, as after --over: "
                                 "\"programs.NAME.eta_rad_s=1,2,3\", \"duration_s=60:600:4\"",
                      .default_text = "[]"}),
          {.most = 20000}, {.fewest = 0, .most = 20}, sweep.over);
  v.flag(
      ofCampaign({"zip", "the n-th values of all keys belong together; false: all combinations"}),
      sweep.zip);
  v.integer(ofCampaign({"seeds", "runs per point, each with a seed of its own"}), 1, 100000,
            sweep.seeds);
  v.integer(ofCampaign({"random", "number of points that are drawn from the ranges; 0: none"}), 0,
            1000000, sweep.random);
  enumerate(v,
            ofCampaign({"sampling",
                        "how points are drawn; latin: a Latin hypercube; sobol: Sobol's sequence"}),
            kSamplings, sweep.sampling);
  v.table(ofCampaign({"adaptive", "Where lab sweep --adaptive measures next (campaigns.md)"}), [&] {
    if (!sweep.adaptive) sweep.adaptive.emplace();
    visitAdaptive(v, *sweep.adaptive);
  });
}

}  // namespace keys

SweepTable readSweepTable(std::string_view text, const std::string& name,
                          const std::vector<std::string>& set) {
  std::vector<std::string> of_sweep;
  for (const std::string& setting : set) {
    if (setting.starts_with("sweep.") || setting.starts_with("sweep=")) of_sweep.push_back(setting);
  }
  const keys::TomlDocument document(text, name, of_sweep);
  keys::Problems problems([&](const std::string& path) { return document.place(path); });
  SweepTable sweep;
  const toml::node* table = document.root().get("sweep");
  if (table == nullptr) return sweep;
  const keys::ExperimentForm form = keys::readForm(
      document, [](const std::string&) { return std::optional<language::ProgramText>(); }, {},
      problems);
  std::vector<std::string> own;
  for (const std::string& line : problems.lines(100)) {
    if (line.find(": sweep") != std::string::npos) own.push_back(line);
  }
  if (!own.empty()) throw ExperimentError(std::move(own));
  return form.sweep;
}

}  // namespace lab
