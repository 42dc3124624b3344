/// The figures of the paper: which panel shows which programs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/laws/law.hpp"

namespace lab::report {

/// A program of the paper with its parameters.
struct PaperSet {
  int number = 0;                        ///< number in the list of all sets; seeds derive from it
  std::string id;                        ///< "abp_eps0.5_eta3": name of its runs, also in tables
  std::string program_name;              ///< its key in the experiment file
  analysis::ProgramLaw law;              ///< of the program, with its parameters
  std::vector<std::string> estimates{};  ///< names of those that tables show
  bool short_recording = false;          ///< the three minutes of figure 4b,c instead of the hour
};

enum class PanelKind {
  kTrajectory,   ///< the path of one recording, with an enlarged part
  kMsd,          ///< MSD against lag; `points` as an inset
  kAngularMsd,   ///< angular MSD against lag; `points` as an inset
  kPersistence,  ///< L_s against eta, C(l) as an inset
  kRunTumble,    ///< speed, its histogram, run times
};

/// Content of the inset of a panel.
enum class Inset { kNone, kDrOverEpsilon, kDrOverEta, kDOverTheory };

struct PaperPanel {
  std::string id;  ///< "2b"
  PanelKind kind = PanelKind::kMsd;
  std::string title;
  std::string given;   ///< parameters that the paper's text gives
  std::string chosen;  ///< parameters that the text does not give, as chosen here; empty: none
  std::vector<std::string> curves;  ///< ids of the drawn sets
  Inset inset = Inset::kNone;
  std::vector<std::string> points{};  ///< ids of the sets of the inset, one point each
  std::string formula{};              ///< formula of the paper ("eq. 4"); empty: none is tested
  /// The parameter by which its curves differ; empty: there is only one curve.
  std::string varied{};
};

/// All sets, in the order of the figures.
[[nodiscard]] const std::vector<PaperSet>& paperSets();

/// All panels of figures 2, 3 and 4, except 4a, which is a drawing.
[[nodiscard]] const std::vector<PaperPanel>& paperPanels();

/// @throws std::out_of_range if there is no set with this id
[[nodiscard]] const PaperSet& paperSet(std::string_view id);

/// The sets that these panels need, in the order of paperSets().
[[nodiscard]] std::vector<PaperSet> setsOf(const std::vector<PaperPanel>& panels);

/// The panels in a list: "2b,3d"; "fig2" or "2" for all of a figure; "" for all.
/// @throws ReportError with the name that is not a panel
[[nodiscard]] std::vector<PaperPanel> choosePanels(std::string_view list);

struct RecordingOptions {
  double hours = 1;        ///< duration of every recording except the short one
  std::uint64_t seed = 1;  ///< seed of the complete reproduction
  int member = 0;          ///< number of the member of an ensemble
  bool through_firmware = false;
};

/// The experiment file that records the set: one robot, walls with reversals, clock errors and PWM
/// steps of the simulator, and the tracking errors of a good camera.
[[nodiscard]] std::string experimentText(const PaperSet& set, const RecordingOptions& options);

}  // namespace lab::report
