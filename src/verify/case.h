// SPDX-License-Identifier: MIT
// A verification case as its file says it, in SI units: where the fluid is, what moves, what is
// measured, and what it is compared with. docs/verify.md describes the files.
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bolus/solver.h"

namespace swallowclip::verify {

enum class Shape { none, box, cylinder, tube, mesh };

/// box: from 0 to size. cylinder: axis z, floor at z = 0, axis at x = y = 0. tube: axis x at
/// y = z = 0, repeats after length. Tilt turns the walls and all that is in them about y.
struct DomainDef {
  Shape shape = Shape::none;
  Vec3 size_m = Vec3::Zero();
  std::array<bool, 3> periodic{false, false, false};
  double radius_m = 0, length_m = 0;  ///< length: height of a cylinder, period of a tube
  double tilt_rad = 0;
  double edge_m = 0;  ///< of wall triangles; 0: one spacing
  std::filesystem::path file;
  double metresPerUnit = 1e-3;
};

enum class MotionKind { still, slide, piston, close, rotate, peristalsis };

/// Piecewise linear speed over time, so that every position is C1. Constant beyond its ends.
struct SpeedProfile {
  std::vector<std::pair<double, double>> points;  ///< time (s), speed (m/s or rad/s)
  double speed(double t_s) const;
  double travel(double t_s) const;  ///< integral from 0
  double final() const { return points.empty() ? 0 : points.back().second; }
};

struct MotionDef {
  MotionKind kind = MotionKind::still;
  int axis = 2;               ///< of the moving face, and of the closing pair
  bool high = true;           ///< the face at the far end of the axis
  Vec3 velocity_ms{0, 0, 0};  ///< slide
  SpeedProfile speed;         ///< piston inwards, close (both plates together), rotate, wave
  double occlusion = 0;       ///< peristalsis: amplitude / mean half width
  int waves = 1;              ///< peristalsis: wavelengths in the domain
};

enum class FillKind { domain, block, sphere, cylinder };

struct FillDef {
  FillKind kind = FillKind::domain;
  Vec3 low_m = Vec3::Zero(), size_m = Vec3::Zero();  ///< block; low is the base of a cylinder
  double radius_m = 0;                               ///< sphere (low: its centre), cylinder
  Vec3 velocity_ms = Vec3::Zero();
  std::string place;  ///< file:line:column
};

enum class StartKind { rest, rotation, taylorGreen };

enum class ErrorRule { max, rms, mean, each, absolute };

/// What is measured; `kind` is a word of quantities.h.
struct QuantityDef {
  std::string kind;
  std::string of = "velocity-x";  ///< profile: field
  std::string along = "z";        ///< profile: coordinate; others: axis
  int bins = 0;                   ///< profile: 0 for one per spacing
  std::array<std::pair<double, double>, 3> within_m{
      {{-1e9, 1e9}, {-1e9, 1e9}, {-1e9, 1e9}}};  ///< window along x, y, z
};

/// What it is compared with; `kind` is a word of references.h, or table, or constant.
struct ReferenceDef {
  std::string kind;
  double value = 0;                               ///< constant
  std::vector<std::pair<double, double>> points;  ///< table, already scaled to SI
  std::string place;                              ///< file:line:column
};

struct CheckDef {
  std::string title;
  QuantityDef quantity;
  ReferenceDef reference;
  double tolerance = 0.02;
  ErrorRule error = ErrorRule::max;
  double from_s = 0;            ///< samples before it are not compared
  double referenceError = 0;    ///< of the reference itself; below it the error need not fall
  std::optional<double> align;  ///< series: shift in time so that both have this value together
  bool alignBest = false;       ///< series: shift in time so that they differ least
};

struct CaseDef {
  std::filesystem::path file;
  std::string name, description, source;
  bool isShort = false;
  bool kernelsOnly = false;  ///< no fluid: kernel integrals and gradients
  double kernelTolerance = 1e-3;
  DomainDef domain;
  MotionDef motion;
  bool slip = false;
  bolus::Fluid fluid;
  Vec3 gravity_ms2{0, 0, -9.81};
  double spacing_m = 1e-3;
  bolus::KernelKind kernel = bolus::KernelKind::cubicSpline;
  bolus::SolverKind solver = bolus::SolverKind::dfsph;
  std::vector<FillDef> fill;
  StartKind start = StartKind::rest;
  double startRate = 0;  ///< rad/s of a rotation, m/s of Taylor-Green
  double relax_s = 0;    ///< at most; the fluid comes to rest between the walls of time 0 first
  double duration_s = 0;
  std::vector<double> samples_s;
  double average_s = 0;  ///< every sample is the mean over this long before it
  std::vector<CheckDef> checks;
  std::vector<double> refine_m;  ///< coarser spacings first; the case's own comes last
};

/// Reads one case and proves that it can be run: form, geometry, fluid inside its walls.
Result<CaseDef> loadCase(const std::filesystem::path& path);
Result<CaseDef> parseCase(std::string text, const std::string& name);
/// The part of that proof that depends on spacings.
Result<void> checkGeometry(const CaseDef& def);
}  // namespace swallowclip::verify
