/// Loops that are compiled for more than one kind of processor.
#pragma once

// The same source for the processor at hand: results do not depend on the choice, as nothing is
// contracted or summed in another order. Sanitizers do not bear the dispatcher.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LAB_TARGET_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define LAB_TARGET_CLONES
#endif
