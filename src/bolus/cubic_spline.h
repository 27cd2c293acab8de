// SPDX-License-Identifier: MIT
// The cubic spline (Monaghan & Lattanzio 1985) and what the solver derives from it, eight at once,
// with q = 2 r / H and in units of W(0) = 8 / (pi H^3).
#pragma once
#include "core/simd.h"

namespace swallowclip::bolus::cubic {
using simd::all;
using simd::F8;

/// W; zero from q = 2 on.
SC_INLINE F8 w(F8 q) {
  const F8 far = simd::largest(all(2) - q, all(0));
  return simd::select(q < all(1), all(1) + q * q * (all(0.75f) * q - all(1.5f)),
                      all(0.25f) * far * far * far);
}
/// (dW/dq) / q; zero from q = 2 on.
SC_INLINE F8 slopePerQ(F8 q) {
  const F8 far = simd::largest(all(2) - q, all(0));
  return simd::select(q < all(1), all(2.25f) * q - all(3),
                      all(-0.75f) * far * far / simd::largest(q, all(1)));
}
/// q^-3 int_0^q W t^2 dt, which is F / r; `inverse` is 1 / q.
SC_INLINE F8 fPerR(F8 q, F8 inverse) {
  const F8 inverse3 = inverse * inverse * inverse;
  const F8 middle = all(2.f / 3) + q * (all(-0.75f) + q * (all(0.3f) - q * all(1.f / 24))) -
                    all(1.f / 60) * inverse3;
  const F8 inner = all(1.f / 3) + q * q * (all(0.125f) * q - all(0.3f));
  return simd::select(q < all(1), inner, simd::select(q < all(2), middle, all(0.25f) * inverse3));
}
}  // namespace swallowclip::bolus::cubic
