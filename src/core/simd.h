// SPDX-License-Identifier: MIT
// Eight floats at a time through the compiler's vector extension: the same operations in the same
// order on every x86-64, whether the machine runs them as one AVX or two SSE instructions, so that
// results do not depend on the processor. SC_CLONES marks a function that is compiled for both and
// chosen when the program starts; what it calls must be SC_INLINE.
#pragma once
#include <emmintrin.h>

#include <cstring>

#define SC_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SC_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define SC_CLONES
#endif

namespace swallowclip::simd {
inline constexpr int kLanes = 8;
using F8 = float __attribute__((vector_size(32)));
using I8 = int __attribute__((vector_size(32)));
using D8 = double __attribute__((vector_size(64)));

SC_INLINE F8 all(float x) {
  return x - F8{};  // becomes one broadcast
}
SC_INLINE I8 allInt(int x) {
  return x - I8{};
}
SC_INLINE F8 load(const float* p) {
  F8 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
SC_INLINE I8 loadInt(const int* p) {
  I8 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
SC_INLINE void store(float* p, F8 v) {
  std::memcpy(p, &v, sizeof v);
}
SC_INLINE F8 gather(const float* p, const int* at) {
  return F8{p[at[0]], p[at[1]], p[at[2]], p[at[3]], p[at[4]], p[at[5]], p[at[6]], p[at[7]]};
}
SC_INLINE F8 select(I8 mask, F8 yes, F8 no) {
  return mask ? yes : no;
}
SC_INLINE F8 largest(F8 a, F8 b) {
  return a > b ? a : b;
}
SC_INLINE F8 smallest(F8 a, F8 b) {
  return a < b ? a : b;
}
SC_INLINE F8 magnitude(F8 a) {
  return a < 0 ? -a : a;
}
SC_INLINE F8 root(F8 a) {
  __m128 half[2];
  std::memcpy(half, &a, sizeof a);
  half[0] = _mm_sqrt_ps(half[0]);
  half[1] = _mm_sqrt_ps(half[1]);
  std::memcpy(&a, half, sizeof a);
  return a;
}
/// Always in this order.
SC_INLINE float sum(F8 a) {
  return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}
SC_INLINE D8 wide(F8 a) {
  return __builtin_convertvector(a, D8);
}
SC_INLINE double sum(D8 a) {
  return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}
SC_INLINE bool any(I8 mask) {
  long long part[4];
  std::memcpy(part, &mask, sizeof part);
  return (part[0] | part[1] | part[2] | part[3]) != 0;
}
}  // namespace swallowclip::simd
