// SPDX-License-Identifier: MIT
// Nearest points and winding numbers on a triangle surface, by a bounding-volume tree in double
// precision. Built per pose (about 20 ms for 40 000 triangles); queries are const and thread-safe.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "core/tri_mesh.h"

namespace swallowclip::airway {

struct SurfacePoint {
  int triangle = -1;  ///< -1: nothing within reach
  Vec3 barycentric = Vec3::Zero();
  Vec3 point = Vec3::Zero();
  double distance_m = std::numeric_limits<double>::infinity();
};

class SurfaceSearch {
 public:
  SurfaceSearch(std::span<const Vec3> positions, std::span<const Triangle> triangles);

  /// Nearest point within `reach_m`; of equally near triangles the one of lowest number.
  SurfacePoint nearest(const Vec3& p,
                       double reach_m = std::numeric_limits<double>::infinity()) const;

  /// Nearest point on a triangle whose normal has a negative product with `normal`: the sheet
  /// across a gap.
  SurfacePoint nearestOpposed(const Vec3& p, const Vec3& normal) const;

  /// Generalised winding number, 1 inside a closed surface that faces outward. Far groups of
  /// triangles count as one dipole (Barill et al. 2018, order 1): absolute error about 0.02.
  double winding(const Vec3& p) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    Vec3 centre = Vec3::Zero(), areaVector = Vec3::Zero();
    double radius_m = 0;
    int begin = 0, end = 0;  ///< triangles of the subtree, in `order_`
    int left = -1, right = -1;
  };

  int build(int begin, int end, std::vector<Vec3>& centroids);
  template <class Accept>
  SurfacePoint search(const Vec3& p, double reach_m, const Accept& accept) const;

  std::vector<std::array<Vec3, 3>> corners_;  ///< [triangle]
  std::vector<int> order_;
  std::vector<Node> nodes_;
};
}  // namespace swallowclip::airway
