// SPDX-License-Identifier: MIT
// A structure made ready to draw: vertices split where the surface has a sharp edge (decided once,
// on the first frame, so that shading never pops), normals per frame, and cap outlines.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/tri_mesh.h"

namespace swallowclip::render {

/// Vertex as the shaders take it: world position, normal, material-fixed position.
struct Vertex {
  Vec3f position, normal, rest;
};

struct DrawMesh {
  std::vector<Triangle> triangles;     ///< of structure vertices
  std::vector<std::uint32_t> indices;  ///< 3 per triangle, into `source`
  std::vector<int> source;             ///< draw vertex -> structure vertex
  std::vector<Vec3f> rest;             ///< [structure vertex], first frame
  bool closed = false;                 ///< closed 2-manifold facing outward
};

/// Corners of one vertex share a draw vertex while their triangles' normals agree within
/// `creaseAngle_rad`.
DrawMesh buildDrawMesh(std::span<const Triangle> triangles, std::span<const Vec3f> positions,
                       double creaseAngle_rad);

/// Vertices with area-weighted normals at these positions.
std::vector<Vertex> drawVertices(const DrawMesh& mesh, std::span<const Vec3f> positions);

/// The curve where a mesh crosses normal . p = offset: end points of directed segments, the inside
/// on one fixed side, so that a fan over them winds once round every point of the section.
std::vector<Vec3f> sectionSegments(std::span<const Triangle> triangles,
                                   std::span<const Vec3f> positions, const Vec3f& normal,
                                   float offset_m);

/// Fan from the segments' mean: winding number 1 over the section, 0 elsewhere.
std::vector<Vertex> sectionFan(std::span<const Vec3f> segments, const Vec3f& normal);

/// Thin ribbons along the segments, in their plane, lifted by `lift_m` towards +normal.
std::vector<Vertex> sectionOutline(std::span<const Vec3f> segments, const Vec3f& normal,
                                   float width_m, float lift_m);
}  // namespace swallowclip::render
