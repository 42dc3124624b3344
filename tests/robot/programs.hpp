#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/program_source.hpp"
#include "robot/language/compiler.hpp"

namespace lab {

/// Programs in memory, by hash.
class MemoryPrograms final : public dynamics::ProgramSource {
 public:
  /// Returns the hash.
  std::uint32_t add(std::vector<std::uint8_t> code) {
    const std::uint32_t hash =
        dynamics::programHash(code.data(), static_cast<std::uint8_t>(code.size()));
    programs_.try_emplace(hash, std::move(code));  // robots may be running it
    return hash;
  }

  [[nodiscard]] const std::vector<std::uint8_t>& code(std::uint32_t hash) const {
    return programs_.at(hash);
  }

  dynamics::ProgramBytes find(std::uint32_t hash) override {
    const auto found = programs_.find(hash);
    dynamics::ProgramBytes bytes;
    if (found != programs_.end()) {
      bytes.code = found->second.data();
      bytes.size = static_cast<std::uint8_t>(found->second.size());
    }
    return bytes;
  }

 private:
  std::map<std::uint32_t, std::vector<std::uint8_t>> programs_;
};

/// The programs of all tests of this executable.
inline MemoryPrograms& testPrograms() {
  static MemoryPrograms programs;
  return programs;
}

/// The byte code of a program without errors. Its wheels may be faster than real ones.
inline std::vector<std::uint8_t> codeOf(const language::ProgramText& text) {
  const language::CompiledProgram program =
      language::compile(text, dynamics::WheelLimits{5.0, 0.075});
  for (const language::Problem& problem : program.errors) {
    ADD_FAILURE() << text.name << ": " << problem.key << ": " << problem.message;
  }
  return program.code;
}

/// Compiles a program into testPrograms() and returns its hash.
inline std::uint32_t hashOf(const language::ProgramText& text) {
  return testPrograms().add(codeOf(text));
}

inline language::PhaseText drivingPhase(std::string name, std::string forward, std::string turn,
                                        std::string hold, std::string next = {}) {
  language::PhaseText phase;
  phase.name = std::move(name);
  phase.forward = std::move(forward);
  phase.turn = std::move(turn);
  phase.hold = std::move(hold);
  phase.next = std::move(next);
  return phase;
}

inline language::PhaseText wheelPhase(std::string left, std::string right, std::string hold) {
  language::PhaseText phase;
  phase.name = "run";
  phase.left = std::move(left);
  phase.right = std::move(right);
  phase.hold = std::move(hold);
  return phase;
}

inline language::ProgramText programText(std::vector<language::PhaseText> phases) {
  language::ProgramText text;
  text.name = "test";
  text.phases = std::move(phases);
  return text;
}

/// The paper's programs, with quantities as texts ("3 cm/s").
inline language::ProgramText abpText(const std::string& v, const std::string& epsilon,
                                     const std::string& eta) {
  language::ProgramText text =
      programText({drivingPhase("run", "v", "uniform(-eta, eta)", "epsilon")});
  text.parameters = {{"v", v}, {"epsilon", epsilon}, {"eta", eta}};
  return text;
}

inline language::ProgramText wheelNoiseText(const std::string& va, const std::string& V,
                                            const std::string& epsilon) {
  language::ProgramText text =
      programText({wheelPhase("uniform(va - V, va + V)", "uniform(va - V, va + V)", "epsilon")});
  text.parameters = {{"va", va}, {"V", V}, {"epsilon", epsilon}};
  return text;
}

inline language::ProgramText rtpText(const std::string& v, const std::string& gamma,
                                     const std::string& tau_t) {
  language::ProgramText text =
      programText({drivingPhase("run", "v", "", "exponential(1/gamma)", "tumble"),
                   drivingPhase("tumble", "", "uniform(-pi, pi) / tau_t", "tau_t", "run")});
  text.parameters = {{"v", v}, {"gamma", gamma}, {"tau_t", tau_t}};
  return text;
}

/// Constant wheel speeds [um/s].
inline language::ProgramText wheelsText(int left, int right) {
  const auto speed = [](int um_s) { return std::to_string(um_s / 1e4) + " cm/s"; };
  return programText({wheelPhase(speed(left), speed(right), "forever")});
}

/// A valid program of exactly this size (17 to 176 bytes), different for every number: it negates a
/// speed many times.
inline std::vector<std::uint8_t> programOfSize(std::uint8_t size, std::uint8_t number) {
  using namespace dynamics;
  std::vector<std::uint8_t> evaluation{kPushByte, number};
  evaluation.resize(size - 13U, kNegate);
  evaluation.insert(evaluation.end(), {kPushByte, 0, kPushShort, 0, 1, kPushPlain, 0, kDrive});
  std::vector<std::uint8_t> code{kByteCodeFormat, 1, 0,
                                 static_cast<std::uint8_t>(evaluation.size())};
  code.insert(code.end(), evaluation.begin(), evaluation.end());
  code.push_back(0);
  EXPECT_EQ(checkByteCode(code.data(), size).fault, kValidByteCode);
  return code;
}

}  // namespace lab
