// SPDX-License-Identifier: MIT
// What a receding meniscus leaves on a wall: a film thinner than a particle, as a volume on each
// triangle of the skin. Particles lend that volume and take it back, so none is made or lost:
//   sum over particles of (V - lent)  +  sum over triangles of the coating  =  all fluid.
// A particle that has lent something still moves as a whole one (an error below one particle for
// each lender); one that has lent all of itself leaves the fluid until all of it has come back.
// Walls that close squeeze their coating on before them. It neither drains nor rubs. SI units.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "bolus/fluid.h"
#include "bolus/neighbours.h"
#include "core/tri_mesh.h"

namespace swallowclip::bolus {

/// Thickness of the film that a meniscus receding at `speed_ms` leaves on the wall of a lumen of
/// that half width: the thinner one of Landau & Levich (1942), 0.944 l Ca^(2/3) with the capillary
/// length l, where gravity holds the meniscus back, and Bretherton (1961) as extended by Aussillous
/// & Quere (2000), R 1.34 Ca^(2/3) / (1 + 3.35 Ca^(2/3)), where the lumen does. Ca takes the
/// viscosity at the film's own shear rate, speed / thickness.
double filmThickness_m(const Fluid& fluid, double gravity_ms2, double speed_ms, double halfWidth_m);

class Coating {
 public:
  enum class Wetness : std::uint8_t { never = 0, wet = 1, left = 2 };

  Coating(const Fluid& fluid, double gravity_ms2, double spacing_m);
  /// Only a fluid with coatingTension_Nm coats walls; of any other all arrays stay empty.
  bool on() const { return fluid_.coatingTension_Nm > 0; }
  void start(std::size_t triangles, std::size_t particles);

  /// The fluid between its walls at one moment.
  struct Scene {
    const Neighbours& neighbours;                      ///< of the places below
    std::span<const Vec3> places, velocities;          ///< [particle]
    std::span<const std::uint8_t> active;              ///< [particle] is in the neighbours
    std::span<const Triangle> triangles;               ///< the skin's first, then caps
    std::span<const std::uint8_t> skipped;             ///< [triangle] no wall now; may be empty
    std::span<const Vec3> wallPlaces, wallVelocities;  ///< [vertex]
    Vec3 period_m = Vec3::Zero();
    ThreadPool& pool;
  };
  /// Moves volume between fluid and walls; returns who has lent all of itself just now.
  std::vector<int> update(const Scene& scene);
  /// A particle that has got all of itself back and looks for room in the fluid.
  struct Waiting {
    int particle, triangle;
  };
  const std::vector<Waiting>& waiting() const { return waiting_; }
  std::vector<Vec3> placesFor(const Scene& scene, const Waiting& waiting) const;
  void cameBack(int particle);
  /// True when walls and fluid have moved far enough for the next update.
  bool isDue(double moved_m);

  const std::vector<double>& volume_m3() const { return volume_m3_; }  ///< [skin triangle]
  const std::vector<double>& lent_m3() const { return lent_m3_; }      ///< [particle]
  const std::vector<Wetness>& wetness() const { return wetness_; }     ///< [skin triangle]
  /// [skin triangle] how fast the contact line went that left it last.
  const std::vector<double>& speed_ms() const { return speed_ms_; }

  /// The same list for saving and going on.
  template <class Archive>
  void archive(Archive& a) {
    a(volume_m3_), a(lent_m3_), a(away_), a(wetness_), a(speed_ms_), a(waiting_), a(sinceUpdate_m_);
  }

 private:
  struct Face {
    Vec3 centre, inward, velocity;
    double area_m2 = 0;
  };
  Face face(const Scene& s, int triangle) const;
  void findNearest(const Scene& s);
  void fluidNear(const Scene& s, const Face& f, std::vector<Neighbours::Near>& out) const;
  void findGaps(const Scene& s);
  void findBeside(const Scene& s);
  double acrossTo(const Scene& s, const Face& f, int triangle) const;
  double gap_m(const Scene& s, const Face& f) const;
  double narrowGap_m(const Scene& s, const Face& f) const;
  void squeeze(const Scene& s, int triangle);
  void deposit(const Scene& s, int triangle, std::vector<int>& left);
  void takeUp(const Scene& s, int triangle, bool revives);
  int nextBack() const;

  Fluid fluid_;
  double gravity_ms2_, spacing_m_, particle_m3_;
  std::vector<double> volume_m3_, lent_m3_, speed_ms_;
  std::vector<std::uint8_t> away_;  // [particle] has left the fluid
  std::vector<Wetness> wetness_;
  std::vector<float> nearest_m_;            // [skin triangle] to the nearest fluid
  std::vector<std::array<int, 3>> beside_;  // [skin triangle]
  std::vector<Waiting> waiting_;
  PointGrid faces_;
  std::vector<Vec3> centres_;     // in the order of faces_
  std::vector<double> narrow_m_;  // [skin triangle] gap where it is narrow, NaN: not yet known
  double sinceUpdate_m_ = 0;
  std::vector<Neighbours::Near> near_;
};
}  // namespace swallowclip::bolus
