// SPDX-License-Identifier: MIT
// Saving and going on. Plain bytes of this machine, for this version only, with a digest.
#include <cstring>

#include "bolus/solver_impl.h"
#include "core/digest.h"

namespace swallowclip::bolus {
namespace {
constexpr std::uint64_t kMark = 0x53574243'0000000c;  // "SWBC", layout 12

class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  void operator()(const std::vector<T>& values) {
    (*this)(static_cast<std::uint64_t>(values.size()));
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  void operator()(const std::vector<std::vector<Contact>>& lists) {
    (*this)(static_cast<std::uint64_t>(lists.size()));
    for (const auto& list : lists) (*this)(list);
  }
  std::string bytes;
};

class Reader {
 public:
  explicit Reader(std::string_view all) : rest_(all) {}
  bool fine = true;
  bool atEnd() const { return rest_.empty(); }

  template <class T>
  void operator()(T& value) {
    take(&value, sizeof value);
  }
  template <class T>
  void operator()(std::vector<T>& values) {
    values.resize(length(sizeof(T)));
    take(values.data(), values.size() * sizeof(T));
  }
  void operator()(std::vector<std::vector<Contact>>& lists) {
    lists.resize(length(sizeof(std::uint64_t)));
    for (auto& list : lists) (*this)(list);
  }

 private:
  std::size_t length(std::size_t each) {
    std::uint64_t n = 0;
    (*this)(n);
    fine = fine && n <= rest_.size() / each;
    return fine ? n : 0;
  }
  void take(void* to, std::size_t size) {
    fine = fine && size <= rest_.size();
    if (!fine || size == 0) return;
    std::memcpy(to, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  std::string_view rest_;
};

/// The same list for writing and reading. Neighbours follow from the places, walls from the time.
template <class Archive, class Impl>
void all(Archive& a, Impl& s) {
  a(s.time_s);
  a(s.stepShare);
  a(s.reach_s);
  a(s.infeasible_s);
  a(s.stats);
  a(s.errorSum);
  a(s.errorCount);
  a(s.aboveTenCount);
  a(s.escapedNow);
  auto& p = s.particles;
  a(p.positions);
  a(p.velocities);
  a(p.densityRatio);
  a(p.pressure_Pa);
  a(p.state);
  a(p.s_m);
  a(p.branch);
  a(s.number);
  a(s.active);
  a(s.walls);
  a(s.contacts);
  a(s.held);
  a(s.contactsAt);
  a(s.wallsBefore);
  a(s.fastestWall_ms);
  a(s.lastStep_s);
  a(s.viscosity.shear().own_s);
  a(s.viscosity.shear().wall_s);
  a(s.viscosity.shear().field);
  a(s.shifting.last().shift);
  a(s.shifting.last().push);
  a(s.viscosity.drags_ms2());
  a(s.viscosity.slopes_s());
  a(s.viscosity.waiting());
  a(s.wallTriangles);
  a(s.caps);
  a(s.shutBefore);
  a(s.skipped);
  if (s.tension) a(s.tension->held());
  s.coating.archive(a);
}

/// What a state must fit: counts and the numbers that shape the flow.
std::uint64_t kindOf(const BolusDef& d, std::size_t triangles) {
  const Fluid& f = d.fluid;
  const double numbers[] = {d.spacing_m,
                            d.volume_m3,
                            d.gravity_ms2.x(),
                            d.gravity_ms2.y(),
                            d.gravity_ms2.z(),
                            d.swallowedAt_s_m,
                            d.longestStep_s,
                            d.courant,
                            d.densityTolerance,
                            d.rateTolerance,
                            d.solveShare,
                            static_cast<double>(d.kernel),
                            static_cast<double>(d.solver),
                            static_cast<double>(d.slip),
                            static_cast<double>(d.full),
                            d.period_m.x(),
                            d.period_m.y(),
                            d.period_m.z(),
                            static_cast<double>(f.model),
                            f.density_kgm3,
                            f.viscosity_Pas,
                            f.consistency_Pasn,
                            f.index,
                            f.yield_Pa,
                            f.eta0_Pas,
                            f.etaInf_Pas,
                            f.lambda_s,
                            f.minViscosity_Pas,
                            f.maxViscosity_Pas,
                            f.surfaceTension_Nm,
                            f.contactAngle_rad,
                            f.coatingTension_Nm,
                            static_cast<double>(triangles)};
  return stateDigest(numbers, sizeof numbers);
}
}  // namespace

std::string Solver::save() const {
  Impl& s = *impl_;
  Writer out;
  out(kMark);
  out(kindOf(s.def, s.motion->triangles.size()));
  all(out, s);
  out(s.projection.densityWarm());
  out(s.projection.rateWarm());
  out(s.wcsph.state());
  out(s.field.box());
  out(stateDigest(out.bytes.data(), out.bytes.size()));
  return std::move(out.bytes);
}

Result<void> Solver::restore(std::string_view bytes) {
  Impl& s = *impl_;
  const auto refuse = [](const char* problem) {
    return failure("checkpoint", problem, "remove it and start the run anew");
  };
  constexpr std::size_t kDigest = sizeof(std::uint64_t);
  std::uint64_t digest = 0, mark = 0, kind = 0;
  if (bytes.size() < 3 * kDigest) return refuse("it is cut short");
  std::memcpy(&digest, bytes.data() + bytes.size() - kDigest, kDigest);
  bytes.remove_suffix(kDigest);
  if (digest != stateDigest(bytes.data(), bytes.size())) return refuse("it is damaged");
  Reader in(bytes);
  in(mark);
  in(kind);
  if (mark != kMark) return refuse("it was written by another version");
  if (kind != kindOf(s.def, s.motion->triangles.size()))
    return refuse("it belongs to another bolus or scene");
  all(in, s);
  const std::size_t n = s.particles.positions.size();
  s.projection.resize(static_cast<int>(n));
  if (s.shifting.last().shift.size() != n || s.shifting.last().push.size() != n ||
      (s.tension && s.tension->held().size() != n))
    return refuse("its arrays do not fit");
  s.projection.full = s.def.full;
  s.projection.tolerances = {s.def.densityTolerance, s.def.rateTolerance, s.def.solveShare};
  WallField::Box box;
  in(s.projection.densityWarm());
  in(s.projection.rateWarm());
  std::array<double, 3> wcsph{};
  in(wcsph);
  s.wcsph.setState(wcsph);
  in(box);
  if (!in.fine || !in.atEnd()) return refuse("its arrays do not fit");
  s.motion->at(s.time_s, s.wallPositions, s.wallVelocities);
  s.field.rebuild(s.wallTriangles, s.wallPositions, s.wallVelocities, box, s.skipped);
  s.wallsStood = false;
  s.lastNearest.assign(s.active.size(), -1);
  s.gap_m.resize(n);
  for (std::size_t i = 0; i < n; ++i) s.gap_m[i] = localGap_m(s.contacts[i]);
  s.outside = {};
  s.findNeighbours();
  return {};
}
}  // namespace swallowclip::bolus
