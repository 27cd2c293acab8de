// SPDX-License-Identifier: MIT
#include "anatomy/rigid_parts.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::anatomy {
namespace {

// ---- sections -------------------------------------------------------------------------------

struct Section {
  Vec3 at, u, v;
  double curl = 0, ridge = 0, ridgeHalfWidth = 1;
  std::vector<Vec2> outline;  ///< (a, b) per ring point
};

std::vector<Vec3> sectionPoints(const Section& s, double scale = 1) {
  std::vector<Vec3> points;
  const Vec3 along = s.v.normalized();
  for (const Vec2& ab : s.outline) {
    const double beside = ab.x() * s.u.norm() / s.ridgeHalfWidth;
    const double bend =
        ab.x() * ab.x() * s.curl + s.ridge * std::exp(-beside * beside) * std::min(0.0, ab.y());
    points.push_back(s.at + scale * (ab.x() * s.u + ab.y() * s.v + bend * along));
  }
  return points;
}

Section mirroredSection(Section s) {
  for (Vec3* p : {&s.at, &s.u, &s.v}) p->x() = -p->x();
  return s;
}

Section between(const Section& s0, const Section& s1, const Section& s2, const Section& s3,
                double t) {
  Section s = s1;
  s.at = catmullRom(s0.at, s1.at, s2.at, s3.at, t);
  s.u = catmullRom(s0.u, s1.u, s2.u, s3.u, t);
  s.v = catmullRom(s0.v, s1.v, s2.v, s3.v, t);
  s.curl = (1 - t) * s1.curl + t * s2.curl;
  s.ridge = (1 - t) * s1.ridge + t * s2.ridge;
  s.ridgeHalfWidth = (1 - t) * s1.ridgeHalfWidth + t * s2.ridgeHalfWidth;
  for (size_t i = 0; i < s.outline.size(); ++i)
    s.outline[i] = (1 - t) * s1.outline[i] + t * s2.outline[i];
  return s;
}

double farthestMove(const Section& a, const Section& b) {
  double far = (b.at - a.at).norm();
  for (double sign : {1.0, -1.0}) {
    far = std::max(far, (b.at + sign * b.u - a.at - sign * a.u).norm());
    far = std::max(far, (b.at + sign * b.v - a.at - sign * a.v).norm());
  }
  return far;
}

// ---- one sweep ------------------------------------------------------------------------------

struct BuiltSweep {
  const SweepDef* def = nullptr;
  std::vector<Ring> rows;
  std::vector<double> station;  ///< station parameter of each row
  std::vector<GridWindow> windows;
};

std::vector<Section> controlSections(const SweepDef& def, int ringPoints,
                                     const std::map<std::string, std::vector<Vec2>>& profiles) {
  std::vector<Section> out;
  for (const StationDef& st : def.stations) {
    Section s{st.at_m, st.u_m, st.v_m, st.curl_m, st.ridge_m, st.ridgeHalfWidth_m, {}};
    const auto profile = profiles.find(st.profile);
    s.outline = profile == profiles.end() ? superellipse(st.exponent, ringPoints, def.half)
                                          : resampleClosed(profile->second, ringPoints);
    out.push_back(std::move(s));
  }
  return out;
}

// Rows between the stations; beyond a midplane end the mirror image continues the curve.
std::vector<Section> denseSections(const SweepDef& def, const std::vector<Section>& control,
                                   std::vector<double>& parameter) {
  const int n = static_cast<int>(control.size());
  auto neighbour = [&](int k) {
    if (k >= 0 && k < n) return control[k];
    const Closure closure = k < 0 ? def.start : def.end;
    if (closure == Closure::midplane && !def.half)
      return mirroredSection(control[k < 0 ? 1 : n - 2]);
    if (def.end == Closure::loop) return control[(k + n) % n];
    return control[k < 0 ? 0 : n - 1];
  };
  std::vector<Section> out;
  const int spans = def.end == Closure::loop ? n : n - 1;
  for (int k = 0; k < spans; ++k) {
    const Section next = neighbour(k + 1);
    const int rows =
        std::max(1, static_cast<int>(std::ceil(farthestMove(control[k], next) / def.edge_m)));
    for (int r = 0; r < rows; ++r) {
      out.push_back(
          between(neighbour(k - 1), control[k], next, neighbour(k + 2), double(r) / rows));
      parameter.push_back(k + double(r) / rows);
    }
  }
  if (def.end != Closure::loop) {
    out.push_back(control.back());
    parameter.push_back(n - 1);
  }
  return out;
}

// Rounded end: shrinking rows on an ellipse of height `dome`, then one pole.
void addDome(HalfSurface& surface, const Section& end, const Vec3& outwards, double dome,
             double edge, bool closed, const Ring& rim, bool ahead) {
  Vec3 axis = end.u.cross(end.v).normalized();
  if (axis.dot(outwards) < 0) axis = -axis;
  const double radius = std::max(end.u.norm(), end.v.norm());
  const bool flat = dome < 0.1 * radius;  // nothing to round: one row keeps the fan apart
  const int rows = flat ? 1 : std::clamp(static_cast<int>(radius / edge), 1, 3);
  std::vector<Ring> rings{rim};
  for (int k = 1; k <= rows; ++k) {
    const double angle = kPi / 2 * k / (rows + 1);
    Section s = end;
    s.at += axis * dome * std::sin(angle);
    rings.push_back(surface.addRow(sectionPoints(s, std::cos(angle))));
  }
  const int pole = surface.addVertex(end.at + axis * dome);
  if (!ahead) std::reverse(rings.begin(), rings.end());
  surface.loft(rings, closed, {});
  surface.capPole(ahead ? rings.back() : rings.front(), closed, pole, ahead);
}

int nearestRow(const BuiltSweep& sweep, double station) {
  int best = 0;
  for (size_t i = 0; i < sweep.station.size(); ++i)
    if (std::abs(sweep.station[i] - station) < std::abs(sweep.station[best] - station))
      best = static_cast<int>(i);
  return best;
}

GridWindow gridWindow(const BuiltSweep& parent, const WindowDef& w) {
  const int n = static_cast<int>(parent.rows[0].size());
  auto column = [&](double angle) {
    return static_cast<int>(
        std::lround(parent.def->half ? (angle + kPi / 2) / kPi * (n - 1) : angle / (2 * kPi) * n));
  };
  GridWindow g{nearestRow(parent, w.station0), nearestRow(parent, w.station1), column(w.angle0_rad),
               column(w.angle1_rad)};
  g.row1 = std::max(g.row1, g.row0 + 1);
  g.column1 = std::max(g.column1, g.column0 + 1);
  return g;
}

Result<BuiltSweep> buildRows(HalfSurface& surface, const SweepDef& def, const Ring& border,
                             const std::map<std::string, std::vector<Vec2>>& profiles) {
  BuiltSweep built;
  built.def = &def;
  const bool closed = !def.half;
  const int ringPoints = border.empty() ? def.ringPoints : static_cast<int>(border.size());
  const std::vector<Section> dense =
      denseSections(def, controlSections(def, ringPoints, profiles), built.station);
  std::vector<int> turn(ringPoints);
  for (int i = 0; i < ringPoints; ++i) turn[i] = i;
  if (!border.empty()) {
    std::vector<Vec3> from;
    for (int v : border) from.push_back(surface.position(v));
    turn = bestTurn(from, sectionPoints(dense[0]));
    built.rows.push_back(border);
    built.station.insert(built.station.begin(), -1);
  }
  for (size_t r = 0; r < dense.size(); ++r) {
    const std::vector<Vec3> points = sectionPoints(dense[r]);
    std::vector<Vec3> turned;
    for (int i : turn) turned.push_back(points[i]);
    const bool flat = !def.half && ((r == 0 && def.start == Closure::midplane) ||
                                    (r + 1 == dense.size() && def.end == Closure::midplane));
    if (flat)
      for (Vec3& p : turned) p.x() = 0;
    built.rows.push_back(surface.addRow(turned));
  }
  if (def.end == Closure::loop) built.rows.push_back(built.rows.front());

  // caps need their sections in the order of the turned rows
  auto turnedSection = [&](Section s) {
    std::vector<Vec2> outline;
    for (int i : turn) outline.push_back(s.outline[i]);
    s.outline = outline;
    return s;
  };
  if (def.start == Closure::dome)
    addDome(surface, turnedSection(dense.front()), dense[0].at - dense[1].at, def.startDome_m,
            def.edge_m, closed, built.rows.front(), false);
  if (def.end == Closure::dome) {
    const Vec3 before =
        dense.size() > 1 ? dense[dense.size() - 2].at : surface.position(built.rows.front()[0]);
    addDome(surface, turnedSection(dense.back()), dense.back().at - before, def.endDome_m,
            def.edge_m, closed, built.rows.back(), true);
  }
  return built;
}
}  // namespace

Result<HalfSurface> sweepPart(const PartDef& part,
                              const std::map<std::string, std::vector<Vec2>>& profiles) {
  HalfSurface surface;
  std::vector<BuiltSweep> built;
  for (const SweepDef& def : part.sweeps) {
    const std::string place = "structure " + part.name + ", sweep " + def.name;
    if (def.stations.empty() || (def.stations.size() < 2 && def.start != Closure::window))
      return usageError(place, "it has too few stations", "give at least two");
    Ring border;
    if (def.start == Closure::window) {
      const auto parent = std::find_if(built.begin(), built.end(), [&](const BuiltSweep& b) {
        return b.def->name == def.parent;
      });
      if (parent == built.end())
        return usageError(place,
                          fmt::format("its parent sweep \"{}\" is not before it", def.parent),
                          "list parents first and name them in \"parent\"");
      const GridWindow window = gridWindow(*parent, def.window);
      const int last = static_cast<int>(parent->rows.size()) - 1;
      if (window.row0 < 0 || window.row1 > last)
        return usageError(place, "its window reaches over the end of the parent",
                          "move window_stations inwards");
      parent->windows.push_back(window);
      border = HalfSurface::windowBorder(parent->rows, !parent->def->half, window);
    }
    auto rows = buildRows(surface, def, border, profiles);
    if (!rows) return std::unexpected(rows.error());
    built.push_back(std::move(*rows));
  }
  for (const BuiltSweep& b : built) surface.loft(b.rows, !b.def->half, b.windows);
  return surface;
}

// ---- teeth ----------------------------------------------------------------------------------
namespace {

/// One level of a crown: height above the cervix, half sizes and cusp modulation in parts of the
/// crown's height, width and depth.
struct CrownLevel {
  double height, width, depth, cusp;
};

// Forms after general tooth morphology (height of contour, incisal edge, cusps); parts assumed
// within 0.1 of typical crowns.
std::vector<CrownLevel> crownLevels(ToothKind kind) {
  switch (kind) {
    case ToothKind::incisor:
      return {{.3, .9, 1, 0}, {.65, 1, .58, 0}, {1, .94, .16, 0}};
    case ToothKind::canine:
      return {{.35, .98, 1, 0}, {.68, .95, .66, 0}, {.97, .3, .24, 0}};
    case ToothKind::premolar:
      return {{.4, 1, 1, 0}, {.75, .96, .86, .05}, {.93, .66, .56, .14}, {.8, .3, .22, .05}};
    case ToothKind::molar:
      return {{.4, 1, 1, 0}, {.76, .97, .9, .04}, {.92, .74, .66, .13}, {.82, .36, .3, .05}};
  }
  return {};
}

// Cusps: premolars one buccal and one lingual, molars four at the corners; -1..1.
double cuspWave(ToothKind kind, double angle) {
  if (kind == ToothKind::premolar) return -std::cos(2 * angle);
  if (kind == ToothKind::molar) return -std::cos(4 * angle);
  return 0;
}

struct ToothFrame {
  Vec3 cervix, mesiodistal, buccal, occlusal;
};

void addTooth(HalfSurface& surface, const ToothDef& tooth, const ToothFrame& f, double root_m) {
  const bool back = tooth.kind == ToothKind::premolar || tooth.kind == ToothKind::molar;
  const int n = back ? 12 : 10;  // ring points
  std::vector<CrownLevel> levels = crownLevels(tooth.kind);
  levels.insert(levels.begin(), {-root_m / tooth.height_m, .62, .7, 0});  // root stub
  std::vector<Ring> rows;
  for (const CrownLevel& level : levels) {
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * kPi * (i + 0.5) / n;
      const double e = 2 / (back ? 2.8 : 2.5);  // squarer than ellipses
      const double c = std::cos(angle), s = std::sin(angle);
      const double w = std::copysign(std::pow(std::abs(c), e), c) * level.width * tooth.width_m / 2;
      const double d = std::copysign(std::pow(std::abs(s), e), s) * level.depth * tooth.depth_m / 2;
      const double h =
          (level.height + level.cusp / 2 * cuspWave(tooth.kind, angle)) * tooth.height_m;
      points.push_back(f.cervix + w * f.mesiodistal + d * f.buccal + h * f.occlusal);
    }
    rows.push_back(surface.addRow(points));
  }
  surface.loft(rows, true, {});
  const double top = back ? 0.74 : tooth.kind == ToothKind::canine ? 1.0 : 1.01;
  surface.capPole(rows.front(), true, surface.addVertex(f.cervix - 1.15 * root_m * f.occlusal),
                  false);
  surface.capPole(rows.back(), true,
                  surface.addVertex(f.cervix + top * tooth.height_m * f.occlusal), true);
}

}  // namespace

Result<std::vector<ToothPlace>> toothPlaces(const DentalArchDef& arch) {
  if (arch.lingualPlan_m.size() < 3)
    return usageError("arch " + arch.name, "its plan curve has fewer than three points",
                      "give (x, y) from the midline backwards");
  const PlanCurve plan(arch.lingualPlan_m);
  const double up = arch.upper ? -1 : 1;
  std::vector<ToothPlace> places;
  double s = 0;
  Vec2 previous(0, 0);
  const ToothDef* before = nullptr;
  for (const ToothDef& tooth : arch.teeth) {
    // walk on until the neighbours' widest parts touch (0.1 mm apart, assumed 0.05-0.2)
    auto centre = [&](double at) -> Vec2 {
      const auto [p, along] = plan.at(at);
      return p + tooth.depth_m / 2 * Vec2(along.y() > 0 ? along.y() : 0, -along.x());
    };
    const double kContact_m = 1e-4, kStep_m = 2e-5;
    while (before
               ? (centre(s) - previous).norm() < (before->width_m + tooth.width_m) / 2 + kContact_m
               : centre(s).x() < tooth.width_m / 2 + kContact_m / 2)
      s += kStep_m;
    const auto [p, along] = plan.at(s);
    previous = centre(s);
    places.push_back({s, Vec3(along.x(), along.y(), 0),
                      Vec3(previous.x(), previous.y(),
                           tooth.tipZ_m - up * tooth.height_m * std::cos(tooth.lean_rad))});
    before = &tooth;
  }
  return places;
}

Result<HalfSurface> dentalArch(const DentalArchDef& arch) {
  const auto places = toothPlaces(arch);
  if (!places) return std::unexpected(places.error());
  HalfSurface surface;
  for (size_t i = 0; i < arch.teeth.size(); ++i) {
    const ToothDef& tooth = arch.teeth[i];
    const Vec3 along = (*places)[i].mesiodistal;
    const Vec3 outwards(along.y(), -along.x(), 0), axis(0, 0, arch.upper ? -1 : 1);
    const double c = std::cos(tooth.lean_rad), n = std::sin(tooth.lean_rad);
    const ToothFrame f{(*places)[i].cervix, along, c * outwards - n * axis,
                       c * axis + n * outwards};
    addTooth(surface, tooth, f, arch.root_m);
  }
  return surface;
}

// ---- maxilla --------------------------------------------------------------------------------

double palateMucosaZ_m(const PalateDef& palate, double x_m, double y_m) {
  const double ratio = std::abs(x_m) / interpolate(palate.halfWidth_m, y_m);
  return interpolate(palate.oralMidline_m, y_m) -
         palate.archDrop_m * std::pow(ratio, palate.archExponent);
}

Result<HalfSurface> maxilla(const PalateDef& palate) {
  const size_t rim = palate.frontRim_m.size();
  if (rim < 3 || rim != palate.backRim_m.size() || palate.sections < 4 ||
      palate.lingualPlan_m.size() < 3)
    return usageError("structure " + palate.name,
                      "front and back rim need the same count of points, three or more, and four "
                      "sections or more",
                      "compare front_rim_mm and back_rim_mm");
  const std::vector<double> kOral{0, .17, .34, .5, .64, .76, .88, 1};  // medial to lingual crest
  const std::vector<double> kNasal{.8, .55, .3, 0};
  const PlanCurve plan(palate.lingualPlan_m);
  HalfSurface surface;
  std::vector<Ring> rows;
  for (int k = 0; k < palate.sections; ++k) {
    const double part = double(k) / (palate.sections - 1);
    const Vec2 crest = plan.at(part * plan.total()).first;
    const Vec2 mid(0, (1 - part) * palate.fanFront_m + part * palate.lingualPlan_m.back().y());
    const Vec2 outwards = (crest - mid).normalized();
    const double t = std::min(1.0, part / 0.35), back = t * t * (3 - 2 * t);  // incisors to molars
    std::vector<Vec3> row;
    for (double f : kOral) {
      const Vec2 p = mid + f * (crest - mid);
      const double z = palateMucosaZ_m(palate, p.x(), p.y()) + palate.mucosa_m;
      row.push_back({p.x(), p.y(), std::max(z, palate.lowest_m)});
    }
    for (size_t i = 0; i < rim; ++i) {
      const Vec2 r = (1 - back) * palate.frontRim_m[i] + back * palate.backRim_m[i];
      const Vec2 p = crest + r.x() * outwards;
      row.push_back({p.x(), p.y(), r.y()});
    }
    for (double f : kNasal) {
      const Vec2 p = mid + f * (crest - mid);
      row.push_back({p.x(), p.y(), interpolate(palate.nasalFloor_m, p.y())});
    }
    if (k == 0)
      for (Vec3& p : row) p.x() = 0;
    row.front().x() = row.back().x() = 0;
    rows.push_back(surface.addRow(row));
  }
  surface.loft(rows, false, {});
  surface.capFold(rows.back());
  return surface;
}
}  // namespace swallowclip::anatomy
