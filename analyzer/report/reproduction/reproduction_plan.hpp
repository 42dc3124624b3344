/// The figures of the paper as data: which panel shows which programs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::report {

/// A program of the paper's with its parameters, recorded on its own.
struct PaperSet {
  int number = 0;                ///< place in the list of all sets, from which its seeds derive
  std::string id;                ///< "abp_eps0.5_eta3": of its runs and in tables
  ProgramSpec program;           ///< SI units
  bool short_recording = false;  ///< the three minutes of figure 4b,c instead of the hour
};

enum class PanelKind {
  kTrajectory,   ///< one recording's path with a part of it enlarged
  kMsd,          ///< MSD against lag; `points` as an inset
  kAngularMsd,   ///< angular MSD against lag; `points` as an inset
  kPersistence,  ///< L_s against eta, C(l) as an inset
  kRunTumble,    ///< speed, its histogram, run times
};

/// What the inset of a panel plots.
enum class Inset { kNone, kDrOverEpsilon, kDrOverEta, kDOverTheory };

struct PaperPanel {
  std::string id;  ///< "2b"
  PanelKind kind = PanelKind::kMsd;
  std::string title;
  std::string given;   ///< parameters that the paper's text gives
  std::string chosen;  ///< those that it does not, and which stand in their place; empty: none
  std::vector<std::string> curves;  ///< ids of the sets that are drawn
  Inset inset = Inset::kNone;
  std::vector<std::string> points{};  ///< ids of the sets of the inset, one point each
  std::string formula{};              ///< the paper's: "eq. 4"; empty: the panel tests none
};

/// Every set once, in the order of the figures.
[[nodiscard]] const std::vector<PaperSet>& paperSets();

/// Every panel of figures 2, 3 and 4 but 4a, which is a drawing.
[[nodiscard]] const std::vector<PaperPanel>& paperPanels();

/// @throws std::out_of_range when there is none of that id
[[nodiscard]] const PaperSet& paperSet(std::string_view id);

/// The sets that these panels need, in the order of paperSets().
[[nodiscard]] std::vector<PaperSet> setsOf(const std::vector<PaperPanel>& panels);

/// The panels that a list names: "2b,3d", "fig2" or "2" for all of a figure, "" for all.
/// @throws ReportError that names what is not a panel
[[nodiscard]] std::vector<PaperPanel> choosePanels(std::string_view list);

struct RecordingOptions {
  double hours = 1;        ///< of every recording but the short one
  std::uint64_t seed = 1;  ///< of the whole reproduction
  int member = 0;          ///< of an ensemble
  bool through_firmware = false;
};

/// The experiment that records the set, as an experiment file: one robot, walls with reversals,
/// clock errors and PWM steps as the simulator gives them, a good camera's tracking errors.
[[nodiscard]] std::string experimentText(const PaperSet& set, const RecordingOptions& options);

}  // namespace lab::report
