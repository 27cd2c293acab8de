// SPDX-License-Identifier: MIT
// Hollow finite element model of a soft structure (thesis 3.2.2): two layers of wedge elements
// extruded inward from the surface triangles. The surface nodes are driven by the sequential
// meshes, not solved for; the inner ones follow along the surface's own normals. Metres, pascal.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "biomech/material.h"
#include "biomech/wedge.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/tri_mesh.h"

namespace swallowclip::biomech {

struct WedgeDef {
  double layer_m = 1e-3;  ///< thickness of one layer, assumed (0.5-2 mm): thinner where it folds
  Material material;
};

/// Strain and stress per element, in the axes of the bind pose: Green-Lagrange strain and second
/// Piola-Kirchhoff stress by Hooke's law, so that rigid motion leaves both at zero.
struct StrainField {
  std::vector<Mat3> strain, stress_Pa;
  std::vector<double> vonMises_Pa, equivalentStrain;
  std::vector<double> nodeVonMises_Pa, nodeStrain;  ///< [surface vertex], mean of outer elements
  double minJacobianRatio = 0;  ///< smallest determinant now over the element's volume at rest
  int foldedElements = 0;       ///< with a determinant <= 0 somewhere
};

class WedgeMesh {
 public:
  static constexpr int kLayers = 2;

  /// Every kept element has positive Jacobians at the bind pose: nodes are drawn closer to the
  /// surface until that holds. A triangle that cannot carry one (no area) is left out and counted.
  static Result<WedgeMesh> build(const TriMesh& surface, const WedgeDef& def);

  int vertices() const { return vertices_; }
  int nodes() const { return (kLayers + 1) * vertices_; }
  int elements() const { return static_cast<int>(elements_.size()); }
  int skippedTriangles() const { return skipped_; }
  double thinnestLayer_m() const;
  const Material& material() const { return material_; }
  /// Node ids in Wedge order; node layer * vertices + v, layer 0 being the surface.
  const std::vector<std::array<int, 6>>& connectivity() const { return elements_; }
  /// Surface triangle that element e was extruded from.
  int triangleOf(int e) const { return triangleOf_[e]; }
  const std::vector<Vec3>& restNodes() const { return rest_; }

  /// All nodes for these surface positions. Thickness follows the free inner face: a sheet that
  /// grows in area by the factor a thins by a^(-nu/(1-nu)) (plane stress).
  std::vector<Vec3> follow(std::span<const Vec3> surface) const;

  StrainField strain(std::span<const Vec3> nodes, ThreadPool& pool) const;
  double volume(std::span<const Vec3> nodes) const;

 private:
  Wedge gather(std::span<const Vec3> nodes, int e) const;
  void directions(std::span<const Vec3> surface, std::vector<Vec3>& out,
                  std::vector<double>& area_m2) const;
  void chooseWeights(std::span<const Vec3> surface);
  void extrude(std::span<const Vec3> surface);

  int vertices_ = 0, skipped_ = 0;
  Material material_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<double, 3>> weights_;  ///< [triangle][corner] share in its vertex normal
  std::vector<double> thickness_m_, restArea_m2_;  ///< [vertex] one layer's
  std::vector<std::array<int, 6>> elements_;
  std::vector<int> triangleOf_;
  std::vector<Vec3> rest_;
};
}  // namespace swallowclip::biomech
