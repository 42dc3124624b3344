/// What is known of a run before anything moves: its experiment.
#pragma once

#include <lab/experiment_event_t.hpp>
#include <lab/program_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::dashboard {

class RunInfo {
 public:
  /// The experiment by its file.
  void set(const Experiment& experiment, const std::string& run);

  enum class RunChange { kNone, kFirst, kOtherRun };

  /// START, which is said again each minute.
  RunChange take(const experiment_event_t& start);

  /// Of EXPERIMENT_STATUS.
  void setRun(const std::string& run, bool replay);

  [[nodiscard]] bool known() const { return experiment_.has_value(); }

  /// Defaults where none is known.
  [[nodiscard]] const Experiment& experiment() const;
  [[nodiscard]] const std::string& text() const { return text_; }  ///< the same as TOML
  [[nodiscard]] const std::string& run() const { return run_; }
  [[nodiscard]] bool replay() const { return replay_; }

  /// Who conducts: sender of START, empty: not heard yet.
  [[nodiscard]] const std::string& conductor() const { return conductor_; }

  /// Why the experiment that was announced cannot be read; empty: it can.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

  /// Place among the experiment's programs in order of name, -1: none of them.
  [[nodiscard]] int indexOf(const program_t& program) const;
  [[nodiscard]] const std::vector<std::string>& programs() const { return names_; }

  /// Of topic `lab`.
  [[nodiscard]] std::string json() const;

 private:
  void use(Experiment experiment, std::string text);

  std::optional<Experiment> experiment_;
  std::vector<std::string> names_;
  std::vector<program_t> messages_;  ///< of the same programs
  std::string text_;                 ///< TOML
  std::string run_;
  std::string version_;
  std::string conductor_;
  std::string trouble_;
  std::int64_t instance_ = 0;  ///< of the conductor
  bool replay_ = false;
};

}  // namespace lab::dashboard
