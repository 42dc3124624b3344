#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lab::language {

/// A name and the text of its expression.
using NamedText = std::pair<std::string, std::string>;

/// A phase as it was written. An empty text means that the key is absent.
struct PhaseText {
  std::string name;
  std::vector<NamedText> set;  ///< New values of state variables, all from the old ones.
  std::string forward;         ///< [cm/s]
  std::string turn;            ///< [rad/s]
  std::string left;            ///< [cm/s], instead of forward and turn
  std::string right;           ///< [cm/s]
  std::string hold;            ///< [s]
  std::string next;            ///< A phase; absent: this one again.
  std::string until;           ///< A condition that ends the hold early.
  std::string then;            ///< The phase that follows then; absent: `next`.

  bool operator==(const PhaseText&) const = default;
};

/// A program of motion as it was written (docs/programs.md).
struct ProgramText {
  std::string name;
  std::string description;
  /// "name" and the closed form's parameters as expressions of the program's, or "msd",
  /// "angular_msd", "D", "D_r" as formulas. Empty: no law is known.
  std::vector<NamedText> law;
  std::vector<NamedText> parameters;
  std::vector<NamedText> state;
  std::vector<PhaseText> phases;  ///< The program starts with the first one.

  bool operator==(const ProgramText&) const = default;
};

}  // namespace lab::language
