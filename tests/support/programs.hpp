/// The shipped programs of motion with parameters in SI units.
#pragma once

#include <cstdio>
#include <lab/program_id_t.hpp>
#include <limits>
#include <string>

#include "common/experiment/program_messages.hpp"
#include "common/programs/shipped_programs.hpp"

namespace lab::test {

/// A parameter of a program in SI units; nan if it has none of that name.
inline double parameter(const Program& program, const std::string& name) {
  for (const ProgramParameter& one : program.parameters) {
    if (one.name == name) return one.value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

inline std::string quantity(double value, const char* unit) {
  char text[48];
  std::snprintf(text, sizeof text, "%.12g %s", value, unit);
  return text;
}

inline std::string cmPerS(double si) { return quantity(si * 100, "cm/s"); }

/// @param v [m/s]
/// @param epsilon [s]
/// @param eta [rad/s]
inline Program abp(double v, double epsilon, double eta) {
  return shippedProgram(
      "abp",
      {{"v", cmPerS(v)}, {"epsilon", quantity(epsilon, "s")}, {"eta", quantity(eta, "rad/s")}},
      kWidestWheels);
}

/// @param va [m/s]
/// @param V [m/s]
/// @param epsilon [s]
inline Program noisyAbp(double va, double V, double epsilon) {
  return shippedProgram("noisy_abp",
                        {{"va", cmPerS(va)}, {"V", cmPerS(V)}, {"epsilon", quantity(epsilon, "s")}},
                        kWidestWheels);
}

/// @param V [m/s]
/// @param epsilon [s]
inline Program bp(double V, double epsilon) {
  return shippedProgram("bp", {{"V", cmPerS(V)}, {"epsilon", quantity(epsilon, "s")}},
                        kWidestWheels);
}

/// @param v [m/s]
/// @param gamma [1/s]
/// @param tau_t [s]
inline Program rtp(double v, double gamma, double tau_t) {
  return shippedProgram(
      "rtp", {{"v", cmPerS(v)}, {"gamma", quantity(gamma, "1/s")}, {"tau_t", quantity(tau_t, "s")}},
      kWidestWheels);
}

/// @param left [m/s]
/// @param right [m/s]
inline Program wheels(double left, double right) {
  return shippedProgram("wheels", {{"left", cmPerS(left)}, {"right", cmPerS(right)}},
                        kWidestWheels);
}

}  // namespace lab::test
