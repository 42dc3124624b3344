#pragma once

#include <cstddef>

namespace lab::analysis {

/// Cosines and sines of n angles (rad), with errors up to 2e-16 for angles up to 1e6; nan for
/// angles that are not finite. The loop can be vectorised. The C library selects an implementation
/// by processor; this one gives the same bits on all.
///
/// Source: Cody and Waite's reduction to [-pi/4, pi/4], fdlibm's polynomials there.
void cosSin(const double* angles, std::size_t n, double* cosines, double* sines);

}  // namespace lab::analysis
