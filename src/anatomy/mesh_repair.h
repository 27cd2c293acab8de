// SPDX-License-Identifier: MIT
// From the loose corners of a mesh file to one surface with vertices that stay the same tissue
// points in all frames: weld, mirror a half, close. All of it is decided on frame 0 and kept as a
// recipe (SurfaceMap) that is then applied to the corners of every frame.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/tri_mesh.h"

namespace swallowclip::anatomy {

enum class HalfSide { left, right, whole, guess };
enum class SurfaceClosure { repair, drawOnly, requireClosed };

/// What a file holds. Readers split vertices at will, so corners may repeat a position.
struct RawMesh {
  std::string file;
  int fileVertices = 0;  ///< as the file counts them, for messages and comparison
  std::vector<Vec3> corners;
  std::vector<std::vector<int>> faces;  ///< polygons of corner indices
  int unusedVertices = 0;               ///< in no face: a hint at a file cut off
};

/// Which corner each vertex takes its position from, and what is done to it on the way.
struct SurfaceMap {
  std::vector<int> corner;             ///< [vertex]
  std::vector<std::uint8_t> mirrored;  ///< [vertex] x is negated
  std::vector<std::uint8_t> onPlane;   ///< [vertex] x is set to 0: seam of a mirrored half
  std::vector<Triangle> triangles;

  std::vector<Vec3> apply(std::span<const Vec3> corners) const;
  /// Largest distance that `apply` moves a seam vertex, m.
  double seamShift(std::span<const Vec3> corners) const;
};

/// Drops vertices that no triangle uses.
void compact(SurfaceMap& map);

/// Welds corners that coincide on frame 0 and proves that all other frames have the same vertices
/// and faces: equal counts and indices, no shared edge torn, no scrambled order. Sheets that only
/// touch on frame 0 and part later stay apart (reported).
Result<SurfaceMap> weldFrames(std::span<const RawMesh> frames, std::vector<std::string>& report);

/// Removes faces lying in x = 0, mirrors the rest and joins both at the seam without new vertices
/// there. `guess` mirrors only what lies on one side and has an open or capped cut in the plane.
Result<void> mirrorHalf(SurfaceMap& map, const RawMesh& rest, HalfSide side, double tolerance_m,
                        const std::string& name, std::vector<std::string>& report);

/// requireClosed: an open surface is an error that names its edges. repair: oriented, stitched and
/// holes filled (CGAL), no vertex moved. drawOnly: as it is. Closed ones end up facing outward.
Result<void> closeSurface(SurfaceMap& map, const RawMesh& rest, SurfaceClosure closure,
                          bool isSequence, const std::string& name,
                          std::vector<std::string>& report);
}  // namespace swallowclip::anatomy
