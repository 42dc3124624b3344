/// The results of a run by program, and their interpretation in words.
#pragma once

#include <string>
#include <vector>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// One program of the run.
struct Finding {
  int key = -1;       ///< index of the program in RunRecord::programs; -1: not one of them
  std::string name;   ///< of the program
  std::string model;  ///< "ABP"
  std::string file;   ///< unique name for files of the program
  const analysis::FeedResult* pool = nullptr;  ///< result of all its robots
  std::vector<const analysis::FeedResult*>
      robots{};  ///< result of each robot; empty if there is only one
};

/// In order of first appearance. The findings point into the record.
[[nodiscard]] std::vector<Finding> findingsOf(const RunRecord& record);

/// "agrees with the exact law", "deviates from the exact law", "undecided".
[[nodiscard]] std::string verdictText(const analysis::ProgramResult& result);

/// The reason of the verdict, in one sentence.
[[nodiscard]] std::string verdictReason(const analysis::ProgramResult& result);

/// Reservations and remarks, one sentence each: contacts, reversals, selection, lost frames, noise.
[[nodiscard]] std::vector<std::string> reservations(const analysis::ProgramResult& result);

/// The estimate that characterises the model: D_t (BP), gamma (RTP), v (no model), else D_r.
/// nullptr if it was not estimated.
[[nodiscard]] const analysis::Estimate* characteristicEstimate(
    const analysis::ProgramResult& result);

/// The difference of the paper's formula from the exact law and the measurement; empty if there is
/// no formula.
[[nodiscard]] std::string paperComparison(const analysis::ProgramResult& result);

/// "v = 3 cm/s, ε = 0.5 s, η = 3 rad/s"
[[nodiscard]] std::string parametersText(const program_t& program);

/// "244 of 12 609 messages (1.9 %) are missing in the log", "at least" if a sender was killed;
/// empty if none is missing.
[[nodiscard]] std::string lossText(const RunRecord& record);

/// What of the log is not used, one line each: messages with impossible numbers or times, events of
/// others than the runner, what is beyond the limits.
[[nodiscard]] std::vector<std::string> refusalTexts(const RunRecord& record);

/// Lines for the terminal: one per program, then losses and faults.
[[nodiscard]] std::vector<std::string> headlines(const RunRecord& record);

}  // namespace lab::report
