/// Numbers the programs of a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <lab/program_id_t.hpp>
#include <vector>

namespace lab::analysis {

/// Gives each program its key: 0, 1, ... in the order of first appearance, -1 for standing.
class ProgramKeys {
 public:
  /// Programs of one run, as in an experiment file. Each one costs simulated recordings.
  static constexpr std::size_t kMost = 100;

  int key(const program_id_t& program) {
    if (program.hash == 0) return -1;
    // Robots keep their program for long, so the last key is tried first.
    if (last_ < programs_.size() && programs_[last_].hash == program.hash) {
      return static_cast<int>(last_);
    }
    for (last_ = 0; last_ < programs_.size(); ++last_) {
      if (programs_[last_].hash == program.hash) return static_cast<int>(last_);
    }
    if (programs_.size() >= kMost) {
      ++left_out_;
      return -1;
    }
    programs_.push_back(program);
    return static_cast<int>(last_);
  }

  [[nodiscard]] const std::vector<program_id_t>& programs() const { return programs_; }

  /// Calls with a program beyond the limit, which counts as standing.
  [[nodiscard]] std::int64_t leftOut() const { return left_out_; }

 private:
  std::vector<program_id_t> programs_;
  std::size_t last_ = 0;
  std::int64_t left_out_ = 0;
};

}  // namespace lab::analysis
