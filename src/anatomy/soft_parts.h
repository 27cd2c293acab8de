// SPDX-License-Identifier: MIT
// Soft structures around the lumen, as closed meshes whose faces towards it are the lumen's own
// sheets: tongue, soft palate, pharyngeal wall, larynx mucosa, cervical esophagus, vocal folds.
// Topology is fixed; positions follow a LumenPose, and the tongue keeps its volume by bulging
// below.
#pragma once
#include <functional>

#include "anatomy/anatomy.h"
#include "anatomy/lumen.h"

namespace swallowclip::anatomy {

/// Control curves of the tongue's underside over s (m), metres.
struct SoftDef {
  Curve tongueFloorY, tongueFloorZ;   ///< midline of the underside
  Curve tongueHalfWidth;              ///< widest half-breadth of a station
  double tongueBreadth_m = 51.9e-3;   ///< Hopkin 1967 in the thesis; the model's scale
  double wallThickness_m = 3e-3;      ///< assumed, 2-4 mm
  double mucosaThickness_m = 1.5e-3;  ///< assumed, 1-3 mm
};

struct SoftPose {
  Vec3 hyoidShift_m = Vec3::Zero();  ///< carries the tongue's root
};

class SoftParts {
 public:
  SoftParts(const Lumen& lumen, SoftDef def);

  /// Names, materials and triangles, at the neutral pose.
  const std::vector<Structure>& structures() const { return structures_; }
  /// Vertex positions of every structure, in the order of structures().
  std::vector<std::vector<Vec3>> positions(const LumenSheets& sheets, const SoftPose& pose) const;

  double tongueVolume_m3() const { return tongueVolume_m3_; }

 private:
  struct Shell {
    std::vector<int> skinVertices;       ///< inner vertex -> skin vertex
    std::vector<Triangle> inner;         ///< over inner vertices, as in the skin
    double thickness_m = 0, lift_m = 0;  ///< outwards and into the lumen from its wall
  };
  std::vector<Vec3> tongue(const LumenSheets& sheets, const SoftPose& pose, double bulge_m) const;
  std::vector<Vec3> keepVolume(const LumenSheets& sheets, const SoftPose& pose) const;
  std::vector<Vec3> velum(const LumenSheets& sheets) const;
  std::vector<Vec3> shell(const Shell& s, const std::vector<Vec3>& skin) const;
  bool ofWall(const Triangle& t, WallId wall) const;
  void addShell(const std::string& name, const std::string& material, Shell shell,
                const std::function<bool(const Triangle&)>& belongs);

  const Lumen& lumen_;
  SoftDef def_;
  double widthScale_ = 1, tongueVolume_m3_ = 0;
  std::vector<Structure> structures_;
  std::vector<Shell> shells_;
};
}  // namespace swallowclip::anatomy
