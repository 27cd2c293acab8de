// SPDX-License-Identifier: MIT
// Inside of the solver: the fluid between the walls of one moment, and one substep.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "bolus/closed_walls.h"
#include "bolus/contact_response.h"
#include "bolus/projection.h"
#include "bolus/shifting.h"
#include "bolus/solver.h"
#include "bolus/tension.h"
#include "bolus/viscosity.h"
#include "bolus/wcsph.h"

namespace swallowclip::bolus {

inline constexpr double kInfeasibleFor_s =
    0.02;  // a pocket without room, before it is said; DESIGN 5

struct Solver::Impl {
  Impl(const BolusDef& d, const WallMotion& m, int threads);

  // What a substep was like.
  struct Substep {
    double length_s = 0;
    double meanError = 0, maxError = 0, maxSpeed_ms = 0;
    int fluidCount = 0, aboveTenPercent = 0, worst = -1;
    ProjectionReport density, rate;
    int viscosityIterations = 0, clamped = 0, rescued = 0;
    bool broken = false;  // a velocity was not a number
  };

  void start(double t_s, std::vector<Vec3> places, std::vector<Vec3> velocities = {});
  /// Walls at t, particles pushed inside them, states, neighbours, wall integrals, densities.
  int meetWalls(double t_s);
  double chooseStep_s(double longest_s);
  Substep substep(double dt_s);  ///< of at most dt_s
  double projectInReach(double dt_s, Substep& report);
  bool outruns(double dt_s, const Vec3& velocity) const;
  template <class Term>
  double largest(int n, Term&& term) const;
  Result<void> checkStep(const Substep& s, double dt_s);
  void finishFrame();  ///< path coordinates of all particles, escape check

  void evaluateWalls(double t_s);
  void lookAtWalls(double t_s);
  void forgetWalls();
  void shutBranches(double t_s);
  void wrapPeriods();
  void sortParticles(std::vector<double>& more);  ///< `more`: a caller's own array of them
  const Particles& asNumbered();
  void findNeighbours();  ///< and the densities
  Neighbours::Range findDensities();
  bool escaped(const Vec3& p) const;
  int pushInside();
  void keepOutOfSlits(int i);
  void updateStates();
  bool isCaught(int i) const;
  bool staysFilm(std::size_t i) const;
  Vec3 filmVelocity_ms(int i) const;
  void keepOnWall(int i);
  void updatePath(bool all);
  void sampleWallsOf(int i);
  bool followWalls(int i);
  double movedSinceHeld_m(int i) const;
  bool isClear(int i);
  double pushLimit_m() const;
  bool findContacts(int i);  ///< true when the particle was outside
  bool followContacts(int i);
  bool compressible() const { return def.solver == SolverKind::wcsph && !frozen; }
  void chooseSound(double speed_ms);
  Flow flow() const { return {neighbours, walls, beside, pool}; }
  void project(double dt_s, Substep& report);
  void pushExplicitly(double dt_s, Substep& report);
  int makeRoom(const Flow& flow, double dt_s);
  void leaveInSlits(double dt_s);
  void move(double dt_s, Substep& report);
  bool clampSpeed(double dt_s, Vec3& velocity) const;
  void coatWalls(const Substep& step);
  bool joins(int i, const Vec3& place);
  void measure(Substep& s);
  std::string wallsAt(int particle) const;

  BolusDef def;
  const WallMotion* motion;
  mutable ThreadPool pool;
  Kernel kernel;
  KernelTable table;
  WallField field;
  double volume_m3;  // in kernel sums: a lattice at rest has density one with every kernel

  Particles particles;
  std::vector<int> number;  // [particle] the first one that it had; empty: none was renumbered
  int stepsUnsorted = 0;
  Particles outside;  // by first numbers; empty: not looked at since the last step
  std::vector<Vec3> wallPositions, wallVelocities;
  std::vector<std::vector<Contact>> contacts;
  std::vector<double> gap_m;  // localGap_m of them
  std::vector<WallSample> walls;
  std::vector<HeldWalls> held;
  double fastestWall_ms = 0;
  std::vector<Vec3> contactsAt, wallsBefore;   // places where contacts were last looked for; walls
  double wallsAt_s = 0;                        // when they were last looked at
  bool wallsStood = false;                     // since the last step
  std::vector<std::pair<Vec3, Vec3>> carried;  // place and velocity had it only moved with its wall
  TriangleRuns runs;                           // of the skin as it is
  std::vector<int> lastNearest;                // [particle] triangle, only a guess
  std::vector<int> takenUp;                    // films that became fluid just now
  mutable std::vector<Neighbours::Near> nearFilm;
  std::vector<std::uint8_t> active;  // takes part in the pressure solve
  Neighbours neighbours;
  std::vector<std::uint8_t> beside;  // see Flow
  std::vector<float> reached;        // [slot] square of its speed, m^2/s^2
  struct {
    std::vector<Vec3> velocities;
    std::vector<double> rate, density;
    Viscosity::Shear shear;
    Viscosity::Waiting waiting;
  } kept;                            // a step, should it be taken again
  std::vector<std::uint8_t> caught;  // [particle] by the walls' shape: film
  std::vector<Vec3> moving;  // velocities, and what the density left above rest adds to them
  Projection projection;
  Shifting shifting;
  Viscosity viscosity;
  Wcsph wcsph;
  std::optional<Tension> tension;  // without surface tension: none
  Coating coating;

  // The skin's triangles, then the caps of its two branches (made when one first shuts).
  std::vector<Triangle> wallTriangles;
  std::array<std::pair<int, int>, 3> caps{};  // [branch] first and end in wallTriangles
  std::array<bool, 3> shutBefore{};           // [branch]
  std::vector<std::uint8_t> skipped;          // [triangle] no wall now
  ColumnIndex columns;
  double filmDrainage_s = 0;  // speed of a draining film per acceleration along the wall
  double time_s = 0, lastStep_s = 0;
  bool frozen = false;  // walls stand still (settling)
  // Settling: honey-like, so that thin fluids do not slosh and yield fluids do come to rest;
  // assumed (0.1 to 1).
  static constexpr double kSettlingViscosity_Pas = 0.5;
  double settlingViscosity_Pas = 0;
  bool mixing = false;        // what does not flow is shifted, too
  double reach_s = INFINITY;  // longest step that contacts reach, where that is what limits it
  double stepShare = 1;       // of the step that speeds allow, less while steps leave compression
  double infeasible_s = 0;    // how long the pocket has been too small
  Stats stats;
  double errorSum = 0, errorCount = 0, aboveTenCount = 0;
  int escapedNow = 0;
};
}  // namespace swallowclip::bolus
