#pragma once

#include <cstddef>

namespace lab::analysis {

/// Cosines and sines of n angles (rad), to 2e-16 for angles up to 1e6, side by side where the
/// machine can; nan of what is not finite. Unlike the library's, of which every processor picks its
/// own, it gives the same bits on all.
///
/// Source: Cody and Waite's reduction to [-pi/4, pi/4], fdlibm's polynomials there.
void cosSin(const double* angles, std::size_t n, double* cosines, double* sines);

}  // namespace lab::analysis
