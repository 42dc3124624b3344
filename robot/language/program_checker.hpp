#pragma once

#include <string>
#include <vector>

#include "robot/language/checked_program.hpp"
#include "robot/language/compiled_program.hpp"
#include "robot/language/key_reader.hpp"
#include "robot/language/program_text.hpp"
#include "robot/language/suggestion.hpp"

namespace lab::language {

/// Checks types and dimensions of a whole program, whose names are right.
class ProgramChecker {
 public:
  /// @param text must outlive the checker
  /// @param suggest for messages about unknown names
  ProgramChecker(const ProgramText& text, Suggest suggest) : text_(text), reader_(text, suggest) {}

  /// Gives a parameter another dimension than its text says. Before check().
  void assume(const std::string& parameter, const Dimension& dimension);

  /// @returns whether there are no errors
  bool check();

  /// Extends the ranges of the state variables until no phase leaves them. After check().
  void findRanges();

  [[nodiscard]] const std::vector<Problem>& errors() const { return reader_.errors(); }
  /// An error says what to write where the unit is wrong.
  [[nodiscard]] bool hasAdvised() const { return reader_.hasAdvised(); }
  [[nodiscard]] const CheckedProgram& program() const { return program_; }

 private:
  void checkParameters();
  void checkLaw();
  void checkFormula(const std::string& name, const std::string& text);
  void checkStates();
  void checkPhases();
  CheckedPhase checkPhase(const PhaseText& phase);
  void checkAssignment(const std::string& key, const std::string& name, const std::string& text,
                       CheckedPhase& checked);
  void checkSpeeds(const std::string& key, const PhaseText& phase, CheckedPhase& checked);
  void checkInterruption(const std::string& key, const PhaseText& phase, CheckedPhase& checked);
  bool extendRanges(bool to_the_limits);

  const ProgramText& text_;
  KeyReader reader_;
  std::string assumed_parameter_;  ///< Empty: none.
  Dimension assumed_dimension_;
  CheckedProgram program_;
};

}  // namespace lab::language
