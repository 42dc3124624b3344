/// The experiment of the run that is shown.
#pragma once

#include <cstdint>
#include <lab/experiment_event_t.hpp>
#include <lab/program_id_t.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::dashboard {

/// Comes from a file, or from START of EXPERIMENT_EVENT.
class RunInfo {
 public:
  /// Sets the experiment from its file.
  void set(const Experiment& experiment, const std::string& run);

  enum class RunChange { kNone, kFirst, kOtherRun };

  /// Takes the event START, which is repeated every minute.
  RunChange take(const experiment_event_t& start);

  /// Sets the facts of EXPERIMENT_STATUS.
  void setRun(const std::string& run, bool replay);

  [[nodiscard]] bool known() const { return experiment_.has_value(); }

  /// The default experiment if none is known.
  [[nodiscard]] const Experiment& experiment() const;
  [[nodiscard]] const std::string& text() const { return text_; }  ///< of the experiment file
  [[nodiscard]] const std::string& run() const { return run_; }
  [[nodiscard]] bool replay() const { return replay_; }

  /// Sender of START, which controls the run; empty before the first one.
  [[nodiscard]] const std::string& runner() const { return runner_; }

  /// Whether it is this start of the sender of START.
  [[nodiscard]] bool isRunner(std::string_view sender, std::int64_t instance) const {
    return sender == runner_ && instance == instance_ && !runner_.empty();
  }

  /// Why the text of START is not a valid experiment; else empty.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

  /// The index of a program in programs(), -1 if it is not one of them.
  [[nodiscard]] int indexOf(const program_id_t& program) const;
  /// Names of the experiment's programs, sorted.
  [[nodiscard]] const std::vector<std::string>& programs() const { return names_; }

  /// JSON of topic `lab`.
  [[nodiscard]] std::string json() const;

 private:
  void use(Experiment experiment, std::string text);

  std::optional<Experiment> experiment_;
  std::vector<std::string> names_;
  std::vector<std::int64_t> hashes_;  ///< of the same programs
  std::string text_;                  ///< the experiment file as TOML
  std::string run_;
  std::string version_;
  std::string runner_;
  std::string trouble_;
  std::int64_t instance_ = 0;  ///< of the runner
  bool replay_ = false;
};

}  // namespace lab::dashboard
