/// Numbers the programs of a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <lab/program_t.hpp>
#include <vector>

#include "common/experiment/program_messages.hpp"

namespace lab::analysis {

/// Gives each program its key: 0, 1, ... in the order of first appearance, -1 for standing.
class ProgramKeys {
 public:
  /// Programs of one run, as in an experiment file. Each one costs simulated recordings.
  static constexpr std::size_t kMost = 100;

  int key(const program_t& program) {
    if (program.kind == program_t::NONE) return -1;
    // Robots keep their program for long, so the last key is tried first.
    if (last_ < programs_.size() && sameProgram(programs_[last_], program)) {
      return static_cast<int>(last_);
    }
    for (last_ = 0; last_ < programs_.size(); ++last_) {
      if (sameProgram(programs_[last_], program)) return static_cast<int>(last_);
    }
    if (programs_.size() >= kMost) {
      ++left_out_;
      return -1;
    }
    programs_.push_back(program);
    return static_cast<int>(last_);
  }

  [[nodiscard]] const std::vector<program_t>& programs() const { return programs_; }

  /// Calls with a program beyond the limit, which counts as standing.
  [[nodiscard]] std::int64_t leftOut() const { return left_out_; }

 private:
  std::vector<program_t> programs_;
  std::size_t last_ = 0;
  std::int64_t left_out_ = 0;
};

}  // namespace lab::analysis
