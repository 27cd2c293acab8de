// SPDX-License-Identifier: MIT
// The lumen from the incisors to the cervical esophagus as two facing sheets over material
// coordinates (s, u): the fixed sheet F (palate, velum, posterior wall) and the moving sheet M
// (tongue, epiglottis and larynx, anterior UES), M = F + gap * n. Gaps never fall below
// `closedGap_m`, so sheets touch but never cross. Two branches leave it: the nasopharyngeal port
// through F behind the uvula, the laryngeal inlet through M behind the epiglottis.
//
//  s  arc length along the bolus path at rest (clinical-reference, section 0), m
//  u  -1 (patient right) .. 1 (left), x = u * halfWidth(s)
//  n  unit normal of the midline in the sagittal plane, from F towards M
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/curve.h"
#include "core/tri_mesh.h"

namespace swallowclip::anatomy {

/// Control curves over s (m). Lengths in metres.
struct LumenDef {
  Curve roofY, roofZ;                ///< midline of F, velum hanging (rest)
  Curve raisedVelumY, raisedVelumZ;  ///< midline of the velum part of F, sealed against the wall
  Curve halfWidth, arch;             ///< lateral half-width; how far F comes towards M at |u| = 1
  Curve restGap;                     ///< midline gap of the neutral pose, every lumen open
  Curve velumThickness;
  Curve nasalWallY;  ///< posterior wall above the port, over z (m)
  Curve inletFrontY, inletFrontZ, inletBackY, inletBackZ, inletHalfWidth;  ///< over depth 0..1
  double length_m = 0.205;
  double velumStart_m = 0.050, uvula_m = 0.082, wallStart_m = 0.086;  ///< port lies in between
  double epiglottisTip_m = 0.108, arytenoid_m = 0.132;                ///< laryngeal inlet rows
  double tongueEnd_m = 0.104, uesStart_m = 0.150;
  double rowStep_m = 1.5e-3;  ///< about the edge length of DESIGN section 4
  int columns = 25;           ///< odd, so that u = 0 is a column
  double closedGap_m = 1e-4;  ///< clinical-reference section 3: closed means 0.1 mm
};

/// Everything that moves, sampled on the rows of a Lumen; kinematics fills it.
struct LumenPose {
  double velumRaise = 0;         ///< 0 hanging .. 1 sealed
  std::vector<double> sigmaF_m;  ///< [row] where the tissue of row s lies along the rest path
  std::vector<double> sigmaM_m;
  std::vector<double> bulge_m;  ///< [row] how far F has moved along n
  std::vector<double> gap_m;    ///< [row * columns] full gap field
  std::vector<double> shear_m;  ///< [row * columns] slip of M down the path (pocket floors)
  /// [row] how far the lateral walls have moved outward, patient left and right; empty: not at all.
  std::vector<double> leftOut_m, rightOut_m;
  Vec3 larynxShift_m = Vec3::Zero();  ///< displacement of the laryngeal frame
  double inletOpen = 1;               ///< AP openness of the vestibule, 0 shut .. 1 rest
  double glottisOpen = 1;             ///< lateral openness of the vocal folds
};

/// Vertex positions of all sheets for one pose.
struct LumenSheets {
  std::vector<Vec3> f, m, velumTop;  ///< [row * columns]; velumTop only on velum rows
  std::vector<Vec3> fNormal;         ///< [row] n at F
  std::vector<Vec3> nasal, inlet;    ///< [(depth-1) * loop] loops of the branches, then caps
};

/// Which anatomical wall a skin vertex belongs to; same numbers as frame::Wall.
enum class WallId : std::uint8_t { palate, velum, posterior, tongue, larynx, esophagus };

/// The airway-skin's topology and material coordinates. Triangles face out of the lumen.
struct SkinLayout {
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> wall, branch;  ///< [vertex]; branch as in bolus::WallMotion
  std::vector<double> s_m, u;
};

class Lumen {
 public:
  explicit Lumen(LumenDef def);

  const LumenDef& def() const { return def_; }
  int rows() const { return rows_; }
  int columns() const { return def_.columns; }
  double s(int row) const { return row * step_; }
  double u(int column) const { return 2.0 * column / (def_.columns - 1) - 1; }
  int rowAt(double s_m) const;
  int index(int row, int column) const { return row * def_.columns + column; }

  /// Pockets of the M sheet at rest: the slip that makes the vallecular floor, m, and the depth
  /// that the pyriform sinuses add to the gap (the aryepiglottic folds take from it), m.
  double valleculaShear(double s_m, double u) const;
  double pyriformGap(double s_m, double u) const;

  /// Neutral bind pose: nothing displaced, every gap at rest width.
  LumenPose neutralPose() const;
  LumenSheets evaluate(const LumenPose& pose) const;

  const SkinLayout& skin() const { return skin_; }
  /// Depth 0..1 of a skin vertex below the laryngeal inlet; 0 elsewhere.
  double inletDepth(int skinVertex) const {
    const auto [sheet, i] = source_[skinVertex];
    if (sheet != 3) return 0;
    return std::min(1.0, (i / inletHole_.loop() + 1.0) / inletDepths_);
  }
  /// Skin vertices in the order of skin().
  std::vector<Vec3> skinPositions(const LumenSheets& sheets) const;

  /// Rows and columns of the two openings, inclusive vertex indices.
  struct Hole {
    int firstRow, lastRow, firstColumn, lastColumn;
    int loop() const { return 2 * (lastRow - firstRow) + 2 * (lastColumn - firstColumn); }
    int rowSpan() const { return lastRow - firstRow; }
    int columnSpan() const { return lastColumn - firstColumn; }
    /// Row and column of loop vertex k: front edge left to right, right edge, back edge, left edge.
    std::array<int, 2> at(int k) const;
  };
  const Hole& port() const { return port_; }
  const Hole& inlet() const { return inletHole_; }

 private:
  Vec3 midline(double sigma_m, double raise, Vec3* normal) const;
  void evaluatePort(const LumenPose& pose, LumenSheets& sheets) const;
  void evaluateInlet(const LumenPose& pose, LumenSheets& sheets) const;
  void buildSkin();

  LumenDef def_;
  int rows_ = 0;
  double step_ = 0;
  Hole port_{}, inletHole_{};
  int portDepths_ = 14, inletDepths_ = 34;
  SkinLayout skin_;
  // skin vertex -> source: sheet (0 F, 1 M, 2 nasal, 3 inlet) and index in it
  std::vector<std::array<int, 2>> source_;
};
}  // namespace swallowclip::anatomy
