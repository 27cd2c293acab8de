// SPDX-License-Identifier: MIT
// Semi-analytic walls on the skin's own triangles (in the spirit of Ferrand et al. 2013). With
// n out of the fluid, r-hat from particle to surface, W and its support H, F and G of KernelTable:
//   lambda      = share of the kernel outside = sum over triangles of int G (r-hat . n) dS
//   grad lambda = sum int W n dS          flux = sum int W (v_wall . n) dS
//   rho / rho0  = sum V W_ij + lambda     D/Dt = sum V (v_i - v_j).gradW + v_i.grad lambda - flux
// The singular part of G is the solid angle (van Oosterom & Strackee 1983), exact; the rest is
// smooth and done by quadrature. Contacts are the nearest wall points with their inward direction.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "bolus/kernels.h"
#include "bolus/neighbours.h"
#include "bolus/wall_integrals.h"
#include "core/tri_mesh.h"

namespace swallowclip::bolus {

struct WallSample {
  double lambda = 0;                     ///< 0 far inside, 1 far outside
  double lambdaSlope = 0;                ///< lambda of the kernel -W' r / 3, as viscosity weighs
  double flux_s = 0;                     ///< 1/s, positive where walls recede
  Vec3 gradLambda = Vec3::Zero();        ///< 1/m, points out of the fluid
  std::array<float, 6> bend{};           ///< its gradient, 1/m^2: xx, yy, zz, xy, xz, yz
  double friction = 0;                   ///< sum int W / distance dS, 1/m^2
  Vec3 frictionVelocity = Vec3::Zero();  ///< the same, times wall velocity
  double area = 0;                       ///< sum int W dS over facing walls, 1/m
  double gap_m = INFINITY;    ///< width of a slit that the particle is alone in; set by the solver
  double normalSpeed_ms = 0;  ///< fastest normal motion of a wall within reach
  double clear_m = 0;         ///< no wall is nearer, as far as is known
  int nearestTriangle = -1;   ///< by centroid; -1 when no wall is within reach
};

/// Walls as they were last integrated for a particle, and where and when that was.
struct HeldWalls {
  WallSample sample;
  Vec3 place = Vec3::Zero();
  double time_s = -INFINITY, fastestWall_ms = 0;  ///< of all walls since then
  /// How far the particle, now there, and the walls may have moved since, together.
  double moved_m(const Vec3& now, double now_s) const {
    return (now - place).norm() + (now_s - time_s) * fastestWall_ms;
  }
};

struct Contact {
  Vec3 point, inward, velocity;  ///< wall point, unit direction into the fluid, its velocity
  double distance_m = 0;         ///< negative when the particle is outside
  int triangle = -1;             ///< index in the skin
};

/// Closest point of the whole surface by brute force, for rare questions; the sooner, the better
/// the `guess` of its triangle (-1: none), on which the answer does not depend.
struct NearestPoint {
  int triangle = -1;
  Vec3 barycentric = Vec3::Zero(), point = Vec3::Zero();
  double distance_m = 0;
};
NearestPoint nearestPoint(const Vec3& p, std::span<const Vec3> positions,
                          std::span<const Triangle> triangles, int guess = -1);

/// The same answers sooner, to the bit, for many questions about one moment: runs of triangles are
/// passed over by the spheres around them.
class TriangleRuns {
 public:
  void build(std::span<const Vec3> positions, std::span<const Triangle> triangles);
  NearestPoint nearest(const Vec3& p, std::span<const Vec3> positions,
                       std::span<const Triangle> triangles, int guess) const;

 private:
  struct Sphere {
    Vec3 centre;
    double radius_m;
  };
  static constexpr int kRun = 32;  // triangles
  std::vector<Sphere> spheres_;
};

class WallField {
 public:
  WallField(const KernelTable& table, double spacing_m);

  /// Takes the triangles within reach of the box [low, high], cut where they are large, but none
  /// that `skip` marks ([triangle], may be empty). `stood`: walls are known to be as in the last
  /// call.
  void build(std::span<const Triangle> triangles, std::span<const Vec3> positions,
             std::span<const Vec3> velocities, const Vec3& low, const Vec3& high,
             std::span<const std::uint8_t> skip = {}, bool stood = false);

  /// The box that the last build reached out from; `rebuild` in the same one gives the same bits.
  struct Box {
    Vec3 low, high;
  };
  Box box() const { return {built_.low, built_.high}; }
  void rebuild(std::span<const Triangle> triangles, std::span<const Vec3> positions,
               std::span<const Vec3> velocities, const Box& box,
               std::span<const std::uint8_t> skip);
  /// The same walls in another field's box, so that no history but that field's shapes the pieces.
  void follow(const WallField& other, std::span<const Triangle> triangles,
              std::span<const Vec3> positions, std::span<const Vec3> velocities,
              std::span<const std::uint8_t> skip);

  WallSample sample(const Vec3& p) const;
  /// The same `moved_m` from there and `since_s` later, where both are little: lambda to second
  /// order, its gradient to first, and the shear as if all of it came from one flat wall.
  WallSample nearTo(const WallSample& sample, const Vec3& moved_m, double since_s) const;

  /// Contacts within radius (<= H), nearest first, at most kMaxContacts of clearly different
  /// direction. Only the first may have a negative distance, and then it is alone.
  static constexpr int kMaxContacts = 8;
  void contacts(const Vec3& p, double radius_m, std::vector<Contact>& out) const;

 private:
  double clearOf_m(const Vec3& p) const;
  struct Piece {
    Vec3 a, b, c, va, vb, vc, normal, centroid;
    double area, radius, normalSpeed;
    int triangle;
  };
  void addPiece(const Piece& whole, int depth);
  Piece makePiece(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& va, const Vec3& vb,
                  const Vec3& vc, int triangle) const;
  bool sameWalls(std::span<const Triangle> triangles, std::span<const Vec3> positions,
                 std::span<const Vec3> velocities, const Vec3& low, const Vec3& high,
                 std::span<const std::uint8_t> skip, bool stood = false);
  void sortPieces();

  const KernelTable* table_;
  double spacing_m_, longestEdge_m_;
  std::vector<Piece> pieces_;  // in the order of their cells
  PieceArrays arrays_;         // the same, from low_
  Vec3 low_ = Vec3::Zero();
  std::vector<Vec3> centroids_;
  double largestRadius_m_ = 0;
  PointGrid grid_;
  // what the pieces were made from, since walls often stand still
  struct Built {
    std::vector<Vec3> positions, velocities;
    std::vector<std::uint8_t> skip;
    std::size_t triangles = 0;
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  } built_;
};
}  // namespace swallowclip::bolus
