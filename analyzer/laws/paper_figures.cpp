#include "analyzer/laws/paper_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "analyzer/laws/closed_forms.hpp"
#include "analyzer/report_error.hpp"
#include "common/math/units.hpp"

namespace lab::report {
namespace {

using units::kCentimetre;

constexpr double kHour = 3600;           // [s]
constexpr double kShortRecording = 180;  // [s] figure 4b
constexpr double kFps = 50;              // needed by figure 3b and gamma = 3
constexpr std::uint64_t kMembers = 1000;
constexpr std::uint64_t kSeeds = kMembers * 1000;

/// @param values of the parameters, SI units
analysis::ProgramLaw law(const std::string& name,
                         const std::vector<std::pair<std::string, double>>& values) {
  return analysis::closedForm(name, values, analysis::kPaperWheelBase);
}

PaperSet abp(double epsilon, double eta) {
  PaperSet set;
  set.id = fmt::format("abp_eps{:g}_eta{:g}", epsilon, eta);
  set.program_name = "abp";
  set.law = law("abp", {{"v", 3 * kCentimetre}, {"epsilon", epsilon}, {"eta", eta}});
  set.estimates = {"v", "D_r", "L_s"};
  return set;
}

PaperSet noisyAbp(double va, double amplitude, double epsilon) {
  PaperSet set;
  set.id = fmt::format("noisy_abp_va{:g}_V{:g}_eps{:g}", va, amplitude, epsilon);
  set.program_name = "noisy_abp";
  set.law = law("noisy_abp",
                {{"va", va * kCentimetre}, {"V", amplitude * kCentimetre}, {"epsilon", epsilon}});
  set.estimates = {"v_a", "D_r", "D_t", "D"};
  return set;
}

PaperSet bp(double amplitude, double epsilon) {
  PaperSet set;
  set.id = fmt::format("bp_V{:g}_eps{:g}", amplitude, epsilon);
  set.program_name = "bp";
  set.law = law("bp", {{"V", amplitude * kCentimetre}, {"epsilon", epsilon}});
  set.estimates = {"V", "D"};
  return set;
}

PaperSet rtp(double gamma, double tau_t, bool short_recording = false) {
  PaperSet set;
  set.id = fmt::format("rtp_gamma{:g}_taut{:g}{}", gamma, tau_t, short_recording ? "_3min" : "");
  set.program_name = "rtp";
  set.law = law("rtp", {{"v", 5 * kCentimetre}, {"gamma", gamma}, {"tau_t", tau_t}});
  set.estimates = {"v", "gamma", "D"};
  set.short_recording = short_recording;
  return set;
}

std::vector<PaperSet> makeSets() {
  std::vector<PaperSet> sets{abp(0.5, 3),
                             abp(0.1, 3),
                             abp(0.25, 3),
                             abp(0.7, 3),
                             abp(0.9, 3),
                             abp(0.25, 1),
                             abp(0.25, 2),
                             abp(0.25, 4),
                             abp(0.25, 5),
                             abp(0.25, 6),
                             noisyAbp(1, 10, 0.1),
                             bp(3, 0.2),
                             bp(5, 0.2),
                             bp(7, 0.2),
                             bp(10, 0.2),
                             bp(7, 0.1),
                             bp(7, 0.4),
                             bp(10, 0.1),
                             bp(10, 0.4),
                             bp(5, 0.4),
                             rtp(3, 0.5, true),
                             rtp(0.5, 0.5),
                             rtp(1, 0.5),
                             rtp(2, 0.5),
                             rtp(3, 0.5),
                             rtp(1, 1),
                             rtp(1, 2)};
  for (std::size_t i = 0; i < sets.size(); ++i) sets[i].number = static_cast<int>(i) + 1;
  return sets;
}

std::vector<PaperPanel> makePanels() {
  const std::string b2 = "abp_eps0.5_eta3";
  const std::string b3 = "noisy_abp_va1_V10_eps0.1";
  const std::string b4 = "rtp_gamma3_taut0.5_3min";
  return {
      {"2a",
       PanelKind::kTrajectory,
       "ABP: trajectory",
       "v = 3 cm/s, ε = 0.5 s, η = 3 rad/s",
       "",
       {b2}},
      {"2b",
       PanelKind::kMsd,
       "ABP: MSD",
       "v = 3 cm/s, ε = 0.5 s, η = 3 rad/s",
       "",
       {b2},
       Inset::kNone,
       {},
       "eq. 4"},
      {"2c",
       PanelKind::kAngularMsd,
       "ABP: angular MSD for three ε",
       "η = 3 rad/s",
       "ε = 0.1, 0.5, 0.9 s (inset also 0.25, 0.7 s), v = 3 cm/s",
       {"abp_eps0.1_eta3", b2, "abp_eps0.9_eta3"},
       Inset::kDrOverEpsilon,
       {"abp_eps0.1_eta3", "abp_eps0.25_eta3", b2, "abp_eps0.7_eta3", "abp_eps0.9_eta3"},
       "2 D_r τ",
       "epsilon"},
      {"2d",
       PanelKind::kAngularMsd,
       "ABP: angular MSD for different η",
       "ε = 0.25 s",
       "η = 1, 3, 6 rad/s (inset 1 to 6 rad/s), v = 3 cm/s",
       {"abp_eps0.25_eta1", "abp_eps0.25_eta3", "abp_eps0.25_eta6"},
       Inset::kDrOverEta,
       {"abp_eps0.25_eta1", "abp_eps0.25_eta2", "abp_eps0.25_eta3", "abp_eps0.25_eta4",
        "abp_eps0.25_eta5", "abp_eps0.25_eta6"},
       "2 D_r τ",
       "eta"},
      {"2e",
       PanelKind::kPersistence,
       "ABP: persistence length",
       "ε = 0.25 s",
       "η = 1 to 6 rad/s, v = 3 cm/s",
       {"abp_eps0.25_eta1", "abp_eps0.25_eta2", "abp_eps0.25_eta3", "abp_eps0.25_eta4",
        "abp_eps0.25_eta5", "abp_eps0.25_eta6"},
       Inset::kNone,
       {},
       "v / D_r",
       "eta"},
      {"3a",
       PanelKind::kTrajectory,
       "Noisy ABP: trajectory",
       "V = 10 cm/s, ε = 0.1 s, v_a = 1 cm/s",
       "",
       {b3}},
      {"3b",
       PanelKind::kMsd,
       "Noisy ABP: MSD",
       "V = 10 cm/s, ε = 0.1 s, v_a = 1 cm/s",
       "",
       {b3},
       Inset::kNone,
       {},
       "eq. 5"},
      {"3c",
       PanelKind::kTrajectory,
       "BP: trajectory",
       "V = 7 cm/s, ε = 0.2 s, v_a = 0",
       "",
       {"bp_V7_eps0.2"}},
      {"3d",
       PanelKind::kMsd,
       "BP: MSD for different V",
       "ε = 0.2 s",
       "V = 3, 5, 7, 10 cm/s; inset also (V, ε) = (7, 0.1), (7, 0.4), (10, 0.1), (10, 0.4), "
       "(5, 0.4) in cm/s and s",
       {"bp_V3_eps0.2", "bp_V5_eps0.2", "bp_V7_eps0.2", "bp_V10_eps0.2"},
       Inset::kDOverTheory,
       {"bp_V3_eps0.2", "bp_V5_eps0.2", "bp_V7_eps0.2", "bp_V10_eps0.2", "bp_V7_eps0.1",
        "bp_V7_eps0.4", "bp_V10_eps0.1", "bp_V10_eps0.4", "bp_V5_eps0.4"},
       "4 D τ",
       "V"},
      {"4b",
       PanelKind::kTrajectory,
       "RTP: trajectory of three minutes",
       "v = 5 cm/s, γ = 3 /s, τ_t = 0.5 s, 3 min",
       "",
       {b4}},
      {"4c",
       PanelKind::kRunTumble,
       "RTP: speed and run times",
       "v = 5 cm/s, γ = 3 /s, τ_t = 0.5 s, 3 min",
       "",
       {b4}},
      {"4d",
       PanelKind::kMsd,
       "RTP: MSD for different γ",
       "τ_t = 0.5 s",
       "γ = 0.5, 1, 2, 3 /s, v = 5 cm/s",
       {"rtp_gamma0.5_taut0.5", "rtp_gamma1_taut0.5", "rtp_gamma2_taut0.5", "rtp_gamma3_taut0.5"},
       Inset::kNone,
       {},
       "eq. 6",
       "gamma"},
      {"4e",
       PanelKind::kMsd,
       "RTP: MSD for three τ_t",
       "γ = 1 /s",
       "τ_t = 0.5, 1, 2 s, v = 5 cm/s",
       {"rtp_gamma1_taut0.5", "rtp_gamma1_taut1", "rtp_gamma1_taut2"},
       Inset::kNone,
       {},
       "eq. 6",
       "tau_t"},
  };
}

/// The keys of an experiment file: the unit is part of the name.
std::string parameters(const PaperSet& set) {
  std::string text = fmt::format("model = \"{}\"\n", set.program_name);
  for (const analysis::LawParameter& one : set.law->parameters()) {
    const bool speed = one.unit == "m/s";
    const std::string unit = speed                 ? "cm_s"
                             : one.unit == "rad/s" ? "rad_s"
                             : one.unit == "1/s"   ? "per_s"
                                                   : one.unit;
    text +=
        fmt::format("{}_{} = {:g}\n", one.name, unit, speed ? one.value / kCentimetre : one.value);
  }
  return text;
}

}  // namespace

const std::vector<PaperSet>& paperSets() {
  static const std::vector<PaperSet> sets = makeSets();
  return sets;
}

const std::vector<PaperPanel>& paperPanels() {
  static const std::vector<PaperPanel> panels = makePanels();
  return panels;
}

const PaperSet& paperSet(std::string_view id) {
  for (const PaperSet& set : paperSets()) {
    if (set.id == id) return set;
  }
  throw std::out_of_range("no set of the paper is called " + std::string(id));
}

std::vector<PaperSet> setsOf(const std::vector<PaperPanel>& panels) {
  std::vector<PaperSet> needed;
  for (const PaperSet& set : paperSets()) {
    const auto holds = [&set](const std::vector<std::string>& ids) {
      return std::find(ids.begin(), ids.end(), set.id) != ids.end();
    };
    const bool wanted = std::any_of(panels.begin(), panels.end(), [&](const PaperPanel& panel) {
      return holds(panel.curves) || holds(panel.points);
    });
    if (wanted) needed.push_back(set);
  }
  return needed;
}

std::vector<PaperPanel> choosePanels(std::string_view list) {
  if (list.empty()) return paperPanels();
  std::vector<std::string> words;
  std::string word;
  for (const char letter : std::string(list) + ",") {
    if (letter == ' ') continue;
    if (letter != ',') {
      word.push_back(letter);
      continue;
    }
    if (word.starts_with("fig")) word.erase(0, 3);
    words.push_back(word);
    word.clear();
  }
  for (const std::string& wanted : words) {
    const bool known = !wanted.empty() && std::any_of(paperPanels().begin(), paperPanels().end(),
                                                      [&](const PaperPanel& panel) {
                                                        return panel.id.starts_with(wanted);
                                                      });
    if (known) continue;
    std::string all;
    for (const PaperPanel& panel : paperPanels()) all += (all.empty() ? "" : ", ") + panel.id;
    throw ReportError(fmt::format(
        "--panels {}: found \"{}\", allowed a list of {} or figures 2, 3, 4 (4a is a drawing)",
        list, wanted, all));
  }
  std::vector<PaperPanel> chosen;
  for (const PaperPanel& panel : paperPanels()) {
    if (std::any_of(words.begin(), words.end(),
                    [&](const std::string& wanted) { return panel.id.starts_with(wanted); })) {
      chosen.push_back(panel);
    }
  }
  return chosen;
}

std::string experimentText(const PaperSet& set, const RecordingOptions& options) {
  // The seed of each set and member does not depend on the selected panels.
  const std::uint64_t seed = options.seed * kSeeds +
                             static_cast<std::uint64_t>(options.member) * kMembers +
                             static_cast<std::uint64_t>(set.number);
  return fmt::format(
      "fileversion = 1\nname = \"{}\"\ndescription = \"A set of the paper's figures\"\nseed = {}\n"
      "duration_s = {:.9g}\nprogram = \"{}\"\n"
      "[[robots]]\nid = 1\nbody = \"{}\"\n"
      "[programs.{}]\n{}"
      // The firmware cannot distinguish walls from robots; there is only one robot.
      "[reversal]\non = \"{}\"\ndistance_cm = 40\n"
      "[camera]\nfps = {}\nposition_noise_cm = 0.03\nheading_noise_deg = 0.6\n",
      set.id, seed, set.short_recording ? kShortRecording : options.hours * kHour, set.program_name,
      options.through_firmware ? "firmware" : "sim", set.program_name, parameters(set),
      options.through_firmware ? "any" : "walls", kFps);
}

}  // namespace lab::report
