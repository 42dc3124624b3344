/// The results of a run, program by program, and what they mean in words.
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
  std::string file;   ///< word for names of files, different for each program
  const analysis::FeedResult* pool = nullptr;         ///< all its robots
  std::vector<const analysis::FeedResult*> robots{};  ///< each; empty where there is only one
};

/// In the order of first appearance. Points into the record.
[[nodiscard]] std::vector<Finding> findingsOf(const RunRecord& record);

/// "agrees with the exact law", "deviates from the exact law", "undecided".
[[nodiscard]] std::string verdictText(const analysis::ProgramResult& result);

/// Why, in one sentence with its numbers.
[[nodiscard]] std::string verdictReason(const analysis::ProgramResult& result);

/// Reservations and remarks, a sentence each: contacts, reversals, selection, lost frames, noise.
[[nodiscard]] std::vector<std::string> reservations(const analysis::ProgramResult& result);

/// The estimate that characterises the model: D_t (BP), gamma (RTP), D_r (ABP), else v. nullptr if
/// it was not estimated.
[[nodiscard]] const analysis::Estimate* characteristicEstimate(
    const analysis::ProgramResult& result);

/// How far the paper's formula is from the exact law and from the measurement, or an empty text
/// where it has none.
[[nodiscard]] std::string paperComparison(const analysis::ProgramResult& result);

/// "v = 3 cm/s, ε = 0.5 s, η = 3 rad/s"
[[nodiscard]] std::string parametersText(const program_t& program);

/// "244 of 12 609 messages (1.9 %) are missing in the log", "at least" where a sender was killed;
/// an empty text when all are there.
[[nodiscard]] std::string lossText(const RunRecord& record);

/// One line per program for the terminal, then losses and faults.
[[nodiscard]] std::vector<std::string> headlines(const RunRecord& record);

}  // namespace lab::report
