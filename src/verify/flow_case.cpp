// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>

#include "pipeline/interrupt.h"
#include "verify/domain.h"
#include "verify/fill.h"
#include "verify/run_case.h"

namespace swallowclip::verify {
namespace {
constexpr int kSnapshotsPerMean = 10;  // assumed (5 to 20)
// An error below this share of what is allowed need not fall on refinement; assumed (0.1 to 5 %).
constexpr double kAlreadyExact = 0.01;
constexpr double kLastShare = 0.02;  // of the time since the last sample, assumed (0.01 to 0.1)
// At least, assumed (30 to 60; 10 to 30): boundary layers of what starts from rest begin thin.
constexpr int kStepsToFirstProfile = 40, kStepsOfMoving = 15;
constexpr int kShifts = 2000;  // tried either way for the best alignment, over the whole run

/// All that one spacing gives: per check its series, or its profiles.
struct Run {
  std::vector<std::vector<Curve>> curves;  // [check]; of a series: one curve over time
  bolus::Stats stats;
  int particles = 0;
};

Snapshot snapshot(const CaseDef& def, const Domain& domain, const bolus::Solver& solver,
                  double spacing) {
  const bolus::Particles& p = solver.particles();
  Snapshot s;
  s.def = &def;
  s.time_s = solver.time_s();
  s.spacing_m = spacing;
  s.particleVolume_m3 = std::pow(spacing, 3);
  for (const Vec3& x : p.positions) s.positions.push_back(domain.fromWorld(x));
  for (const Vec3& v : p.velocities) s.velocities.push_back(domain.fromWorld(v));
  s.pressure_Pa = p.pressure_Pa;
  s.densityRatio = p.densityRatio;
  std::vector<Vec3> x, v;
  const bolus::Coating& coating = solver.coating();
  if (coating.on()) domain.walls().at(s.time_s, x, v);
  for (std::size_t k = 0; k < coating.wetness().size(); ++k) {
    if (coating.wetness()[k] != bolus::Coating::Wetness::left) continue;
    const Triangle& t = domain.walls().triangles[k];
    const double area_m2 = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).norm() / 2;
    s.patches.push_back({domain.fromWorld((x[t[0]] + x[t[1]] + x[t[2]]) / 3), area_m2,
                         coating.volume_m3()[k] / area_m2, coating.speed_ms()[k]});
  }
  if (def.gravity_ms2.norm() > 0) s.up = domain.fromWorld(-def.gravity_ms2.normalized());
  s.escaped = solver.ledger().escaped;
  return s;
}

Result<Start> relaxed(const CaseDef& def, const Domain& domain, bolus::BolusDef bolusDef,
                      Start start) {
  // A full room has nowhere to settle: a driving force would only stir it.
  const bool full =
      std::ranges::any_of(def.fill, [](const FillDef& f) { return f.kind == FillKind::domain; });
  if (full) bolusDef.gravity_ms2.setZero();
  bolus::Solver solver(bolusDef, domain.walls(), 1);
  if (auto ok = solver.place(0, start.positions); !ok) return std::unexpected(ok.error());
  if (auto ok = solver.mix(0); !ok) return std::unexpected(ok.error());
  if (def.relax_s > 0)
    if (auto ok = solver.relax(0, def.relax_s); !ok) return std::unexpected(ok.error());
  for (std::size_t i = 0; i < start.positions.size(); ++i) {
    const Vec3 &from = start.positions[i], &to = solver.particles().positions[i];
    start.velocities[i] += domain.toWorld(startVelocity(def, domain.fromWorld(to)) -
                                          startVelocity(def, domain.fromWorld(from)));
  }
  start.positions = solver.particles().positions;
  return start;
}

Result<Run> runAt(const CaseDef& def, double spacing_m, const std::vector<Reference>& references) {
  Run run;
  auto domain = Domain::build(def, spacing_m);
  if (!domain) return std::unexpected(domain.error());
  auto filled = fillDomain(def, *domain, spacing_m);
  if (!filled) return std::unexpected(filled.error());
  bolus::BolusDef bolusDef;
  bolusDef.fluid = def.fluid;
  bolusDef.spacing_m = filled->spacing_m;
  bolusDef.volume_m3 = filled->volume_m3;
  bolusDef.gravity_ms2 = def.gravity_ms2;
  bolusDef.kernel = def.kernel;
  bolusDef.solver = def.solver;
  bolusDef.period_m = domain->period_m();
  bolusDef.slip = def.slip;
  bolusDef.full = def.fill.size() == 1 && def.fill.front().kind == FillKind::domain;
  // Viscosity is implicit, of first order in time: a profile must not be looked at after a few
  // steps.
  if (std::ranges::any_of(def.checks, [](const auto& c) { return c.quantity.kind == "profile"; }))
    bolusDef.longestStep_s =
        std::min(bolusDef.longestStep_s,
                 def.samples_s.front() /
                     (def.start == StartKind::rest ? kStepsToFirstProfile : kStepsOfMoving));
  auto start = relaxed(def, *domain, bolusDef, std::move(*filled));
  if (!start) return std::unexpected(start.error());
  bolus::Solver solver(bolusDef, domain->walls(), 1);
  if (auto ok = solver.place(0, start->positions, start->velocities); !ok)
    return std::unexpected(ok.error());
  run.particles = static_cast<int>(start->positions.size());
  Vec3 momentum = Vec3::Zero();
  for (const Vec3& v : start->velocities) momentum += domain->fromWorld(v);
  momentum *= def.fluid.density_kgm3 * std::pow(bolusDef.spacing_m, 3);

  run.curves.resize(def.checks.size());
  for (std::size_t c = 0; c < def.checks.size(); ++c)
    if (def.checks[c].quantity.kind != "profile") run.curves[c].emplace_back();
  double before = 0;
  for (double sample : def.samples_s) {
    const int count = def.average_s > 0 ? kSnapshotsPerMean : 1;
    std::vector<ProfileSum> profiles(def.checks.size());
    std::vector<double> sums(def.checks.size(), 0.0);
    double times = 0;
    for (int k = 0; k < count; ++k) {
      if (pipeline::interrupted()) return std::unexpected(pipeline::interruptedError());
      const double t = sample - def.average_s * (count - 1 - k) / count;
      if (t < before) continue;
      // pressures are means over the last advance, so that one is short
      const double last = count > 1 ? def.average_s / count : kLastShare * (t - before);
      const double from = std::max(before, t - last);
      before = t;
      for (const double end : {from, t})
        if (auto ok = solver.advanceTo(end); !ok) return std::unexpected(ok.error());
      Snapshot s = snapshot(def, *domain, solver, bolusDef.spacing_m);
      s.firstMomentum = momentum;
      ++times;
      for (std::size_t c = 0; c < def.checks.size(); ++c) {
        const CheckDef& check = def.checks[c];
        const bool profile = check.quantity.kind == "profile";
        if (profile && sample < check.from_s) continue;
        if (profile)
          profiles[c].add(check.quantity, s, references[c]);
        else
          sums[c] += measureSeries(check.quantity, s);
      }
    }
    if (solver.ledger().escaped > 0)
      return failure(fmt::format("t = {:.4f} s", solver.time_s()),
                     fmt::format("{} particles outside the walls", solver.ledger().escaped),
                     "Report it: fluid never leaves closed walls.");
    for (std::size_t c = 0; c < def.checks.size(); ++c) {
      const CheckDef& check = def.checks[c];
      if (times == 0) continue;
      if (check.quantity.kind == "profile") {
        if (sample >= check.from_s) run.curves[c].push_back({sample, profiles[c].points()});
      } else {
        const double t = sample - def.average_s * (count - 1) / (2.0 * count);
        run.curves[c][0].points.push_back({t, sums[c] / times, 0});
      }
    }
  }
  run.stats = solver.stats();
  return run;
}

/// Time at which a rising series of points passes a value.
double timeOf(const std::vector<ProfileSum::Point>& points, double value) {
  for (std::size_t k = 1; k < points.size(); ++k)
    if (points[k - 1].measured <= value && points[k].measured >= value) {
      const double rise = points[k].measured - points[k - 1].measured;
      const double share = rise > 0 ? (value - points[k - 1].measured) / rise : 0;
      return points[k - 1].along + share * (points[k].along - points[k - 1].along);
    }
  return NAN;
}
double timeOf(const Reference& reference, double value, double longest) {
  double start = longest / 1e7;  // a moment at which the reference says something
  while (start < longest && !std::isfinite(reference({Vec3::Zero(), start, start}))) start *= 1.05;
  double low = 0, high = longest;
  for (int k = 0; k < 100; ++k) {
    const double t = (low + high) / 2;
    const double at = reference({Vec3::Zero(), t, t});
    // before its first point a table counts as below the value, beyond its last as above
    const bool below = std::isfinite(at) ? at < value : t < start;
    (below ? low : high) = t;
  }
  return (low + high) / 2;
}

/// The time shift that leaves the least mean square of relative differences: for experiments whose
/// time origin is unknown and whose single readings scatter.
double bestShift(const CheckDef& check, const Reference& reference, const Curve& curve) {
  const auto cost = [&](double shift) {
    double sum = 0, count = 0, asked = 0;
    for (const auto& p : curve.points) {
      if (p.along < check.from_s) continue;
      ++asked;
      const double t = p.along + shift, r = reference({Vec3::Zero(), t, t});
      if (!std::isfinite(r) || r == 0) continue;
      sum += (p.measured / r - 1) * (p.measured / r - 1);
      ++count;
    }
    return 2 * count < asked || count == 0 ? INFINITY : sum / count;
  };
  const double longest_s = curve.points.empty() ? 0 : curve.points.back().along;
  double best = 0, least = INFINITY;
  for (int k = -kShifts; k <= kShifts; ++k)
    if (const double shift = longest_s * k / kShifts, c = cost(shift); c < least)
      least = c, best = shift;
  return std::isfinite(least) ? best : NAN;
}

/// Fills the reference of a series; with `align`, shifted in time. False when it cannot be. What
/// lies before `from_s` serves the shift only.
bool referToSeries(const CheckDef& check, const Reference& reference, Curve& curve) {
  double shift = 0;
  if (check.alignBest) {
    shift = bestShift(check, reference, curve);
    if (!std::isfinite(shift)) return false;
  } else if (check.align) {
    const double measured = timeOf(curve.points, *check.align);
    if (!std::isfinite(measured)) return false;
    shift = timeOf(reference, *check.align, 1e3) - measured;
  }
  for (auto& p : curve.points) {
    const double t = p.along + shift;
    p.reference = reference({Vec3::Zero(), t, t});
  }
  std::erase_if(curve.points, [&](const auto& p) {
    return p.along < check.from_s || !std::isfinite(p.reference);
  });
  return true;
}

/// Error of one curve by the check's rule; the worst point's values with it.
double errorOf(ErrorRule kind, const Curve& curve, double& measured, double& reference) {
  double scale = 0, worst = -1, squares = 0, sum = 0;
  for (const auto& p : curve.points) scale = std::max(scale, std::abs(p.reference));
  for (const auto& p : curve.points) {
    const double difference = std::abs(p.measured - p.reference);
    squares += difference * difference;
    sum += difference;
    const double own =
        kind == ErrorRule::each ? difference / std::max(std::abs(p.reference), 1e-300) : difference;
    if (!(own <= worst)) worst = own, measured = p.measured, reference = p.reference;
  }
  const double n = static_cast<double>(curve.points.size());
  if (n == 0) return INFINITY;
  if (kind == ErrorRule::absolute || kind == ErrorRule::each) return worst;
  const double value = kind == ErrorRule::rms    ? std::sqrt(squares / n)
                       : kind == ErrorRule::mean ? sum / n
                                                 : worst;
  return value / std::max(scale, 1e-300);
}

CheckResult judge(const CheckDef& check, const Reference& reference, std::vector<Curve> curves) {
  CheckResult r;
  const Unit unit = unitOf(check.quantity);
  r.title = check.title;
  r.unit = unit.text;
  r.series = check.quantity.kind != "profile";
  r.xLabel = r.series ? "time (s)" : check.quantity.along + " (mm)";
  r.tolerance = check.tolerance;
  r.absolute = check.error == ErrorRule::absolute;
  if (r.series && !curves.empty() && !referToSeries(check, reference, curves[0])) {
    r.error = INFINITY;
    r.title += " (cannot be aligned with the reference)";
  }
  for (Curve& curve : curves) {
    double measured = 0, wanted = 0;
    const double error = errorOf(check.error, curve, measured, wanted);
    if (!(error < r.error) || &curve == &curves.front())
      r.error = std::max(r.error, error), r.measured = measured * unit.perSi,
      r.reference = wanted * unit.perSi;
    for (auto& p : curve.points) {
      p.along *= r.series ? 1 : 1e3;
      p.measured *= unit.perSi;
      p.reference *= unit.perSi;
    }
  }
  if (curves.empty() || !std::isfinite(r.error)) r.error = INFINITY;
  if (r.absolute) r.error *= unit.perSi, r.tolerance *= unit.perSi;
  r.pass = r.error <= r.tolerance;
  r.curves = std::move(curves);
  return r;
}
}  // namespace

Result<CaseResult> runCase(const CaseDef& def) {
  if (def.kernelsOnly) return runKernelCase(def);
  CaseResult result;
  result.name = def.name;
  result.description = def.description;
  result.source = def.source;
  result.solver = bolus::name(def.solver);
  result.spacing_m = def.spacing_m;
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Reference> references;
  for (const CheckDef& check : def.checks) {
    auto made = makeReference(def, check.reference);
    if (!made) return std::unexpected(made.error());
    references.push_back(*made);
  }
  std::vector<double> spacings = def.refine_m;
  spacings.push_back(def.spacing_m);
  std::vector<std::vector<double>> errors;  // [spacing][check]
  for (double spacing : spacings) {
    auto run = runAt(def, spacing, references);
    if (!run) {
      if (pipeline::interrupted()) return std::unexpected(run.error());
      result.failure = run.error().text();
      break;
    }
    errors.emplace_back();
    result.checks.clear();
    for (std::size_t c = 0; c < def.checks.size(); ++c) {
      result.checks.push_back(judge(def.checks[c], references[c], std::move(run->curves[c])));
      errors.back().push_back(result.checks.back().error);
    }
    result.stats = run->stats;
    result.particles = run->particles;
  }
  if (result.failure.empty() && spacings.size() > 1)
    for (std::size_t c = 0; c < result.checks.size(); ++c) {
      CheckResult& check = result.checks[c];
      const double coarse = errors.front()[c], fine = errors.back()[c];
      check.coarseError = coarse;
      check.order = std::log(std::max(coarse, 1e-300) / std::max(fine, 1e-300)) /
                    std::log(spacings.front() / spacings.back());
      const double share =
          std::max(kAlreadyExact, def.checks[c].referenceError / def.checks[c].tolerance);
      const double exact = share * check.tolerance;
      check.pass = check.pass && (fine < coarse || fine < exact);
    }
  result.pass = result.failure.empty() && !result.checks.empty() &&
                std::ranges::all_of(result.checks, [](const CheckResult& c) { return c.pass; });
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}
}  // namespace swallowclip::verify
