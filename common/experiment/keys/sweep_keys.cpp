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

/// A key that is read, and not part of the experiment of a run.
Key ofCampaign(Key key) {
  key.need = Need::kShorthand;
  return key;
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
}

}  // namespace keys

SweepTable readSweepTable(std::string_view text, const std::string& name) {
  const keys::TomlDocument document(text, name, {});
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
