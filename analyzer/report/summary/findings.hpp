/// The results of a run by program, and their interpretation in words. Report and terminal
/// print these sentences; tests and docs/first_experiment.md quote some of them.
#pragma once

#include <string>
#include <vector>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// The results of one program.
struct Finding {
  int key = -1;      ///< index in RunRecord::programs; -1: the program is not in that list
  std::string name;  ///< name of the program in the experiment file
  std::string colour = "#9A9A9A";  ///< of the program
  std::string model;               ///< title of its law
  std::string file;                ///< the name as part of file names, different for each program
  const analysis::FeedResult* pool = nullptr;  ///< result of all robots with this program together
  /// Result of each robot with this program; empty if there is only one.
  std::vector<const analysis::FeedResult*> robots{};
};

/// One finding per program, in order of first appearance. They hold pointers into `record`, which
/// must outlive them.
[[nodiscard]] std::vector<Finding> findingsOf(const RunRecord& record);

/// What must be known before the verdict, which is about free motion: "94.7 % of the time is not
/// free motion (contact 94.7 %)". Empty if at most a tenth of the time is cut.
[[nodiscard]] std::string restriction(const analysis::ProgramResult& result);

/// "speed 0.34 cm/s, MSD 2.1 cm² in 10 s" of the whole motion; empty if it was not measured.
[[nodiscard]] std::string wholeMotionText(const analysis::ProgramResult& result);

/// The same of the free motion; empty if there was none.
[[nodiscard]] std::string freeMotionText(const analysis::ProgramResult& result);

/// Whether contacts, or more time in reversals than in free motion, forbid to show an agreement
/// without reserve.
[[nodiscard]] bool isRestricted(const analysis::ProgramResult& result);

/// "agrees with the exact law", "deviates from the exact law", "undecided".
[[nodiscard]] std::string verdictText(const analysis::ProgramResult& result);

/// How far the speed is from the programmed one, and how far it may be off for the verdict:
/// "speed +0.21 % from the programmed one, up to 4 % allowed". Empty if the speed is not free.
[[nodiscard]] std::string speedAllowance(const analysis::ProgramResult& result);

/// "no parameters of the law describe the curves (p = 2e-71)", "p = 2e-05 for the programmed
/// parameters"; empty if the p-values give no reason for the verdict.
[[nodiscard]] std::string misfitText(const analysis::ProgramResult& result);

/// The reason of the verdict, in one sentence.
[[nodiscard]] std::string verdictReason(const analysis::ProgramResult& result);

/// What a reader must know about the numbers, one sentence each: contacts, reversals, windows that
/// are a biased selection, frames that were not used, noise.
[[nodiscard]] std::vector<std::string> caveats(const analysis::ProgramResult& result);

/// The estimate that characterises the law (Law::characteristicEstimate); v without a law.
/// nullptr if it was not estimated.
[[nodiscard]] const analysis::Estimate* characteristicEstimate(
    const analysis::ProgramResult& result);

/// How far the paper's formula differs from the exact law, and how many standard errors that is in
/// this run; empty if the paper has no formula.
[[nodiscard]] std::string paperComparison(const analysis::ProgramResult& result);

/// "v = 3 cm/s, ε = 0.5 s, η = 3 rad/s"
[[nodiscard]] std::string parametersText(const analysis::FeedResult& result);

/// "244 of 12 609 messages (1.9 %) missing in the log". Begins with "at least" if a sender ended
/// without its last count. Empty if none is missing.
[[nodiscard]] std::string lossText(const RunRecord& record);

/// What of the log is not used, one line each: messages with impossible numbers or times, events of
/// others than the runner, what is beyond the limits.
[[nodiscard]] std::vector<std::string> refusalTexts(const RunRecord& record);

/// Lines for the terminal: one per program, then losses and faults.
[[nodiscard]] std::vector<std::string> headlines(const RunRecord& record);

}  // namespace lab::report
