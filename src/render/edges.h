// SPDX-License-Identifier: MIT
// Smooth edges of a finished picture: where neighbouring pixels differ, the course of the edge is
// read off its steps and each pixel beside it is mixed by the share that the true edge would cover
// (after the idea of Reshetov 2009, "Morphological Antialiasing"). Measured against four samples
// per pixel in tests/render/test_edges.cpp.
#pragma once
#include "core/image.h"

namespace swallowclip::render {

/// Pixels of different alpha (which structure is seen) or of clearly different colour lie on two
/// sides of an edge. Alpha becomes 255.
void smoothEdges(Image& image);
}  // namespace swallowclip::render
