// SPDX-License-Identifier: MIT
// Triangle meshes in metres, counter-clockwise seen from outside.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/vec.h"

namespace swallowclip {

using Triangle = std::array<int, 3>;

struct TriMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

/// What stops a mesh from being a closed, consistently oriented 2-manifold.
struct ManifoldReport {
  int openEdges = 0;         ///< edges with one triangle
  int nonManifoldEdges = 0;  ///< edges with more than two triangles
  int flippedEdges = 0;      ///< edges walked twice in the same direction
  int badVertices = 0;       ///< vertices whose triangles form more than one fan
  int degenerate = 0;        ///< triangles that repeat a vertex
  std::array<int, 2> firstBadEdge{-1, -1};

  bool closed() const {
    return openEdges + nonManifoldEdges + flippedEdges + badVertices + degenerate == 0;
  }
  std::string text() const;
};

ManifoldReport checkManifold(std::span<const Triangle> triangles, int vertexCount);

/// Signed volume in m^3 (positive when triangles face outward).
double volume(const TriMesh& mesh);
double volume(std::span<const Vec3> positions, std::span<const Triangle> triangles);

/// Area-weighted unit vertex normals; shape [vertices].
std::vector<Vec3> vertexNormals(std::span<const Vec3> positions,
                                std::span<const Triangle> triangles);

/// Closest point on triangle abc to p, as barycentric weights (Ericson 2005, sec. 5.1.5).
Vec3 closestBarycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Generalised winding number of p (van Oosterom & Strackee 1983 solid angle / 4 pi):
/// 1 inside a closed outward-facing mesh, 0 outside.
double windingNumber(const Vec3& p, std::span<const Vec3> positions,
                     std::span<const Triangle> triangles);
}  // namespace swallowclip
