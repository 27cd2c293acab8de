// SPDX-License-Identifier: MIT
// What a colour-blind eye makes of a colour, and how far two colours lie apart to any eye.
#pragma once
#include <array>

#include "render/render_preset.h"

namespace swallowclip::render {

enum class Vision { normal, protan, deutan, tritan };
inline constexpr std::array kVisions{Vision::normal, Vision::protan, Vision::deutan,
                                     Vision::tritan};
const char* name(Vision vision);

/// Machado, Oliveira & Fernandes 2009 (IEEE TVCG 15:1291), severity 1.0, in linear RGB.
Colour seenBy(Vision vision, const Colour& srgb);

/// CIEDE2000 (Sharma, Wu & Dalal 2005), D65; 1 is just noticeable side by side.
double colourDifference(const Colour& a_srgb, const Colour& b_srgb);

/// The same between CIE L*a*b* coordinates.
double ciede2000(const Vec3& lab1, const Vec3& lab2);

/// Linear light of an sRGB component triple (IEC 61966-2-1).
Vec3f linear(const Colour& srgb);
/// The inverse, of one component.
float toSrgb(float linear);
}  // namespace swallowclip::render
