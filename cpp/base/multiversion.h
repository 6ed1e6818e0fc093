#pragma once

// One source, compiled for several instruction sets, chosen when the library is loaded. The results are the same bits:
// contraction to fused multiply-add is off, and a loop over lanes does not reorder anything within a lane.
// It needs GCC and an ELF loader with indirect functions; elsewhere, or with WCT_BASELINE, the baseline is all there
// is.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__gnu_linux__) && !defined(WCT_BASELINE)
#define WCT_MULTIVERSION __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define WCT_MULTIVERSION
#endif

#if defined(_MSC_VER)
#define WCT_INLINE __forceinline
#else
#define WCT_INLINE inline __attribute__((always_inline))
#endif
