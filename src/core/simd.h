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
using I4 = int __attribute__((vector_size(16)));
using F4 = float __attribute__((vector_size(16)));
using D4 = double __attribute__((vector_size(32)));

// Through a half: from the eight one by one the compiler makes eight insertions or stores.
SC_INLINE F8 all(float x) {
  if (__builtin_constant_p(x)) return F8{x, x, x, x, x, x, x, x};
  const F4 half = _mm_set1_ps(x);
  return __builtin_shufflevector(half, half, 0, 1, 2, 3, 0, 1, 2, 3);
}
SC_INLINE I8 allInt(int x) {
  if (__builtin_constant_p(x)) return I8{x, x, x, x, x, x, x, x};
  const I4 half = I4(_mm_set1_epi32(x));
  return __builtin_shufflevector(half, half, 0, 1, 2, 3, 0, 1, 2, 3);
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
struct F8x3 {
  F8 x, y, z;
};
/// The first three of `stride` floats each: p[stride at[k]] and the two behind it.
template <int stride = 4>
SC_INLINE F8x3 gather3(const float* p, const int* at) {
  const auto pair = [&](int k) {
    F4 a, b;
    std::memcpy(&a, p + stride * static_cast<long>(at[k]), sizeof a);
    std::memcpy(&b, p + stride * static_cast<long>(at[k + 4]), sizeof b);
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
  };
  const F8 a = pair(0), b = pair(1), c = pair(2), d = pair(3);
  const F8 xy = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const F8 xyNext = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const F8 z = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const F8 zNext = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  return {__builtin_shufflevector(xy, xyNext, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(xy, xyNext, 2, 3, 10, 11, 6, 7, 14, 15),
          __builtin_shufflevector(z, zNext, 0, 1, 8, 9, 4, 5, 12, 13)};
}
struct F8x4 {
  F8 x, y, z, w;
};
/// The same with the fourth.
template <int stride = 4>
SC_INLINE F8x4 gather4(const float* p, const int* at) {
  const F8x3 three = gather3<stride>(p, at);
  F8 fourth;
  for (int k = 0; k < kLanes; ++k) fourth[k] = p[stride * static_cast<long>(at[k]) + 3];
  return {three.x, three.y, three.z, fourth};
}
/// Rows of eight floats at p[stride at[k]], turned into eight columns.
template <int stride>
SC_INLINE void gather8(const float* p, const int* at, F8 (&out)[8]) {
  F8 r[8], pairs[8], fours[8];
  for (int k = 0; k < 8; ++k) r[k] = load(p + stride * static_cast<long>(at[k]));
  for (int k = 0; k < 4; ++k) {
    pairs[2 * k] = __builtin_shufflevector(r[2 * k], r[2 * k + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    pairs[2 * k + 1] = __builtin_shufflevector(r[2 * k], r[2 * k + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (int h = 0; h < 2; ++h)
    for (int k = 0; k < 2; ++k) {
      const F8 a = pairs[4 * h + k], b = pairs[4 * h + 2 + k];
      fours[4 * h + 2 * k] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
      fours[4 * h + 2 * k + 1] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (int k = 0; k < 4; ++k) {
    out[k] = __builtin_shufflevector(fours[k], fours[4 + k], 0, 1, 2, 3, 8, 9, 10, 11);
    out[4 + k] = __builtin_shufflevector(fours[k], fours[4 + k], 4, 5, 6, 7, 12, 13, 14, 15);
  }
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
SC_INLINE F8 root(F8 a) {  // halves put together in a register: through memory they would wait
  const F4 low = _mm_sqrt_ps(__builtin_shufflevector(a, a, 0, 1, 2, 3));
  const F4 high = _mm_sqrt_ps(__builtin_shufflevector(a, a, 4, 5, 6, 7));
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
/// Always in this order: ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7)).
SC_INLINE float sum(F8 a) {
  const F4 fours =
      __builtin_shufflevector(a, a, 0, 1, 2, 3) + __builtin_shufflevector(a, a, 4, 5, 6, 7);
  const F4 twos = fours + __builtin_shufflevector(fours, fours, 2, 3, 2, 3);
  return twos[0] + twos[1];
}
/// sum of x, of y, of z, and 0.
SC_INLINE F4 sum3(F8 x, F8 y, F8 z) {
  const auto halves = [](F8 a) {
    return __builtin_shufflevector(a, a, 0, 1, 2, 3) + __builtin_shufflevector(a, a, 4, 5, 6, 7);
  };
  const F4 a = halves(x), b = halves(y), c = halves(z), none{};
  const F4 ab = __builtin_shufflevector(a, b, 0, 4, 1, 5),
           ab2 = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const F4 cd = __builtin_shufflevector(c, none, 0, 4, 1, 5),
           cd2 = __builtin_shufflevector(c, none, 2, 6, 3, 7);
  const F4 first =
      __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab2, cd2, 0, 1, 4, 5);
  return first + (__builtin_shufflevector(ab, cd, 2, 3, 6, 7) +
                  __builtin_shufflevector(ab2, cd2, 2, 3, 6, 7));
}
SC_INLINE F4 load4(const float* p) {
  F4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
SC_INLINE void store4(float* p, F4 v) {
  std::memcpy(p, &v, sizeof v);
}
/// Eight sums in double precision.
struct D8 {
  D4 low{}, high{};
  SC_INLINE void add(F8 a) {
    low += __builtin_convertvector(__builtin_shufflevector(a, a, 0, 1, 2, 3), D4);
    high += __builtin_convertvector(__builtin_shufflevector(a, a, 4, 5, 6, 7), D4);
  }
};
SC_INLINE double sum(const D8& a) {
  const D4 s = a.low + a.high;
  return (s[0] + s[2]) + (s[1] + s[3]);
}
/// Lane k of a comparison is bit k.
SC_INLINE unsigned bits(I8 mask) {
  __m128 half[2];
  std::memcpy(half, &mask, sizeof mask);
  return static_cast<unsigned>(_mm_movemask_ps(half[0]) | _mm_movemask_ps(half[1]) << 4);
}
SC_INLINE bool any(I8 mask) {
  return bits(mask) != 0;
}
inline constexpr I8 kCount{0, 1, 2, 3, 4, 5, 6, 7};
/// [bits] the lanes whose bit is set, in order, then some that are not.
struct LanesOf {
  alignas(32) int of[256][kLanes] = {};
  unsigned char count[256] = {};
  constexpr LanesOf() {
    for (int mask = 0; mask < 256; ++mask) {
      int n = 0;
      for (int lane = 0; lane < kLanes; ++lane)
        if (mask >> lane & 1) of[mask][n++] = lane;
      count[mask] = static_cast<unsigned char>(n);
    }
  }
};
inline constexpr LanesOf kLanesOf;
/// Writes first + lane for every set lane of a mask (and rubbish behind, up to eight in all);
/// returns how many.
SC_INLINE int putLanes(I8 mask, int first, int* out) {
  const unsigned m = bits(mask);
  const I8 at = loadInt(kLanesOf.of[m]) + allInt(first);
  std::memcpy(out, &at, sizeof at);
  return kLanesOf.count[m];
}
/// The same with the values of the set lanes.
SC_INLINE int putValues(I8 mask, I8 values, int* out) {
  const unsigned m = bits(mask);
  const I8 at = __builtin_shuffle(values, loadInt(kLanesOf.of[m]));
  std::memcpy(out, &at, sizeof at);
  return kLanesOf.count[m];
}
SC_INLINE int putValues(I8 mask, F8 values, float* out) {
  const unsigned m = bits(mask);
  store(out, __builtin_shuffle(values, loadInt(kLanesOf.of[m])));
  return kLanesOf.count[m];
}
}  // namespace swallowclip::simd
