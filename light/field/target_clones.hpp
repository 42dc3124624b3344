/// Compiles functions for several processors, selected at run time.
#pragma once

// All clones give the same results, since nothing is contracted or reordered. Sanitizers do not
// support the dispatcher (ifunc).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LAB_TARGET_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define LAB_TARGET_CLONES
#endif
