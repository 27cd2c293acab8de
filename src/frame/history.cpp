// SPDX-License-Identifier: MIT
#include "frame/history.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "core/digest.h"
#include "core/error.h"

namespace swallowclip::frame {
namespace {

// Head and neck fit in half a metre around the posterior nasal spine; a coordinate beyond this is
// in millimetres or garbage. assumed, range 0.5 to 5 m.
constexpr float kFarthest_m = 2.0f;
// Unit quaternions of our own best fits are exact to 1e-12; assumed, range 1e-9 to 1e-3.
constexpr double kQuaternionTolerance = 1e-6;

/// Collects the first fault found; later checks are then skipped.
struct Checker {
  std::string fault;

  bool fine() const { return fault.empty(); }
  void require(bool ok, const std::string& what) {
    if (fine() && !ok) fault = what;
  }
  void count(const std::string& what, std::size_t found, std::size_t expected) {
    if (fine() && found != expected)
      fault = fmt::format("{}: {} entries, {} expected", what, found, expected);
  }
  void finite(const std::string& what, double value) {
    if (fine() && !std::isfinite(value)) fault = fmt::format("{}: not a finite number", what);
  }

  void values(const std::string& what, const std::vector<float>& list) {
    for (std::size_t i = 0; fine() && i < list.size(); ++i)
      if (!std::isfinite(list[i])) fault = fmt::format("{}: entry {} is not finite", what, i);
  }
  void vectors(const std::string& what, const std::vector<Vec3f>& list, bool isPosition) {
    for (std::size_t i = 0; fine() && i < list.size(); ++i) {
      if (!list[i].allFinite())
        fault = fmt::format("{}: entry {} is not finite", what, i);
      else if (isPosition && list[i].cwiseAbs().maxCoeff() > kFarthest_m)
        fault = fmt::format("{}: entry {} is {:.3g} m from the origin; metres below {} expected",
                            what, i, list[i].cwiseAbs().maxCoeff(), kFarthest_m);
    }
  }
  void triangles(const std::string& what, const std::vector<Triangle>& list, std::size_t vertices) {
    for (std::size_t i = 0; fine() && i < list.size(); ++i)
      for (int v : list[i])
        if (v < 0 || static_cast<std::size_t>(v) >= vertices)
          require(false, fmt::format("{}: triangle {} names vertex {}, 0 to {} expected", what, i,
                                     v, static_cast<long long>(vertices) - 1));
  }
  template <class E>
  void words(const std::string& what, const std::vector<E>& list, E last) {
    for (std::size_t i = 0; fine() && i < list.size(); ++i)
      if (list[i] > last)
        fault = fmt::format("{}: entry {} is {}, 0 to {} expected", what, i,
                            static_cast<int>(list[i]), static_cast<int>(last));
  }

  /// [frame][count] of anything, each frame looked at by `each`.
  template <class T, class F>
  void perFrame(const std::string& what, const std::vector<std::vector<T>>& list,
                std::size_t frames, std::size_t expected, F&& each) {
    count(what, list.size(), frames);
    for (std::size_t f = 0; fine() && f < list.size(); ++f) {
      const std::string place = fmt::format("{} frame {}", what, f);
      count(place, list[f].size(), expected);
      if (fine()) each(place, list[f]);
    }
  }
  void perFrame(const std::string& what, const std::vector<std::vector<Vec3f>>& list,
                std::size_t frames, std::size_t expected, bool isPosition) {
    perFrame(what, list, frames, expected,
             [&](const std::string& place, const auto& row) { vectors(place, row, isPosition); });
  }
};

void checkMeta(Checker& c, const History& h) {
  const Meta& m = h.meta;
  c.require(m.version == kHistoryVersion,
            fmt::format("meta version is {}, {} expected", m.version, kHistoryVersion));
  c.require(std::isfinite(m.fps) && m.fps > 0, "meta fps: a positive number expected");
  for (const auto& [what, value] : {std::pair{"cue_s", m.cue_s},
                                    {"density_kgm3", m.density_kgm3},
                                    {"viscosity_Pas", m.viscosity_Pas},
                                    {"bariumSulfate_kgm3", m.bariumSulfate_kgm3},
                                    {"particleSpacing_m", m.particleSpacing_m},
                                    {"meanDensityError", m.meanDensityError},
                                    {"maxDensityError", m.maxDensityError},
                                    {"shareAboveTenPercent", m.shareAboveTenPercent},
                                    {"maxSpeed_ms", m.maxSpeed_ms}})
    c.finite(fmt::format("meta {}", what), value);
  for (double cue : m.cues_s) c.finite("meta cues_s", cue);
  c.require(h.frames() > 0, "time_s: at least one frame expected");
  for (std::size_t f = 0; c.fine() && f < h.time_s.size(); ++f) {
    c.finite(fmt::format("time_s frame {}", f), h.time_s[f]);
    if (f > 0)
      c.require(h.time_s[f] > h.time_s[f - 1], fmt::format("time_s: frame {} is not later", f));
  }
}

/// Names become HDF5 groups and file names, so they are plain words.
void checkNames(Checker& c, const std::string& what, const std::string& word,
                std::set<std::string>& seen) {
  constexpr std::size_t kLongest = 100;  // assumed, range 30 to 200 (file names end at 255 bytes)
  bool plain = !word.empty() && word.size() <= kLongest && word[0] != '.' && word[0] != ' ';
  for (unsigned char ch : word)
    if (ch < 0x20 || ch == 0x7f || ch == '/' || ch == '\\') plain = false;
  c.require(plain,
            fmt::format("{} name \"{}\": a plain word without slashes expected", what, word));
  c.require(seen.insert(word).second, fmt::format("{} name \"{}\" is used twice", what, word));
}

void checkStructures(Checker& c, const History& h) {
  const std::size_t frames = h.time_s.size();
  std::set<std::string> seen;
  for (const StructureTrack& s : h.structures) {
    checkNames(c, "structure", s.name, seen);
    const std::string place = "structure " + s.name;
    c.vectors(place + " rest", s.rest, true);
    c.triangles(place + " triangles", s.triangles, s.rest.size());
    c.count(place + (s.rigid ? " positions (rigid)" : " poses (soft)"),
            s.rigid ? s.positions.size() : s.poses.size(), 0);
    if (!s.rigid) {
      c.perFrame(place + " positions", s.positions, frames, s.rest.size(), true);
      continue;
    }
    c.count(place + " poses", s.poses.size(), frames);
    for (std::size_t f = 0; c.fine() && f < s.poses.size(); ++f) {
      const Pose& p = s.poses[f];
      c.require(std::abs(p.q.norm() - 1) <= kQuaternionTolerance,
                fmt::format("{} pose {}: quaternion of length 1 expected", place, f));
      c.require(p.t.allFinite() && p.t.cwiseAbs().maxCoeff() <= kFarthest_m,
                fmt::format("{} pose {}: translation in metres below {} expected", place, f,
                            kFarthest_m));
    }
  }
}

void checkSkin(Checker& c, const History& h) {
  const SkinTrack& s = h.skin;
  const std::size_t vertices = s.wall.size();
  const std::size_t frames = s.triangles.empty() && vertices == 0 ? 0 : h.time_s.size();
  c.triangles("skin triangles", s.triangles, vertices);
  c.words("skin wall", s.wall, Wall::esophagus);
  c.count("skin s_m", s.s_m.size(), vertices);
  c.count("skin u", s.u.size(), vertices);
  c.values("skin s_m", s.s_m);
  c.values("skin u", s.u);
  c.perFrame("skin positions", s.positions, frames, vertices, true);
  c.perFrame("skin velocities", s.velocities, frames, vertices, false);
  if (!s.film_m.empty())
    c.perFrame("skin film_m", s.film_m, frames, s.triangles.size(),
               [&](const std::string& place, const auto& row) { c.values(place, row); });
}

void checkBolus(Checker& c, const History& h) {
  const BolusTrack& b = h.bolus;
  const std::size_t frames = b.positions.empty() ? 0 : h.time_s.size();
  const std::size_t particles = b.positions.empty() ? 0 : b.positions.front().size();
  const auto numbers = [&](const std::string& place, const auto& row) { c.values(place, row); };
  c.require(std::isfinite(b.particleVolume_m3) && b.particleVolume_m3 >= 0,
            "bolus particleVolume_m3: a finite number, not negative, expected");
  c.perFrame("bolus positions", b.positions, frames, particles, true);
  c.perFrame("bolus velocities", b.velocities, frames, particles, false);
  c.perFrame("bolus densityRatio", b.densityRatio, frames, particles, numbers);
  c.perFrame("bolus s_m", b.s_m, frames, particles, numbers);
  c.perFrame("bolus state", b.state, frames, particles,
             [&](const std::string& place, const auto& row) {
               c.words(place, row, ParticleState::coating);
             });
  c.perFrame(
      "bolus region", b.region, frames, particles,
      [&](const std::string& place, const auto& row) { c.words(place, row, Region::swallowed); });
  if (!b.lentShare.empty()) c.perFrame("bolus lentShare", b.lentShare, frames, particles, numbers);
  if (!h.ledger.empty()) c.count("ledger", h.ledger.size(), h.time_s.size());
}

template <class T>
std::uint64_t addDigest(std::uint64_t seed, const std::vector<std::vector<T>>& list, int frame) {
  if (list.empty()) return seed;
  const std::vector<T>& row = list[static_cast<std::size_t>(frame)];
  if (row.empty()) return seed;  // no particles and no list of particles are the same
  return stateDigest(row.data(), row.size() * sizeof(T), seed);
}
}  // namespace

const char* name(Region region) {
  switch (region) {
    case Region::oral:
      return "oral";
    case Region::oropharynx:
      return "oropharynx";
    case Region::nasopharynx:
      return "nasopharynx";
    case Region::hypopharynx:
      return "hypopharynx";
    case Region::larynx:
      return "larynx";
    case Region::esophagus:
      return "esophagus";
    case Region::swallowed:
      return "swallowed";
  }
  return "unknown";
}

std::vector<Vec3f> StructureTrack::at(int frame) const {
  CHECK_LE(0, frame);
  const auto f = static_cast<std::size_t>(frame);
  if (!rigid) {
    CHECK_LT(f, positions.size());
    return positions[f];
  }
  CHECK_LT(f, poses.size());
  const Mat3 rotation = poses[f].q.toRotationMatrix();
  std::vector<Vec3f> moved(rest.size());
  for (std::size_t v = 0; v < rest.size(); ++v)
    moved[v] = (rotation * rest[v].cast<double>() + poses[f].t).cast<float>();
  return moved;
}

const StructureTrack* History::find(const std::string& wanted) const {
  for (const StructureTrack& s : structures)
    if (s.name == wanted) return &s;
  return nullptr;
}

const LandmarkTrack* History::landmark(const std::string& wanted) const {
  for (const LandmarkTrack& l : landmarks)
    if (l.name == wanted) return &l;
  return nullptr;
}

std::string History::validate() const {
  Checker c;
  checkMeta(c, *this);
  if (c.fine()) checkStructures(c, *this);
  if (c.fine()) checkSkin(c, *this);
  if (c.fine()) checkBolus(c, *this);
  std::set<std::string> seen;
  for (const LandmarkTrack& l : landmarks) {
    checkNames(c, "landmark", l.name, seen);
    c.count("landmark " + l.name, l.positions.size(), time_s.size());
    c.vectors("landmark " + l.name, l.positions, true);
  }
  for (const Event& e : plannedEvents) {
    bool plain = !e.name.empty();
    for (unsigned char ch : e.name) plain = plain && ch >= 0x20;
    c.require(plain, "event: a name of one line expected");
    c.finite("event " + e.name, e.time_s);
  }
  return c.fault;
}

std::uint64_t History::digest(int frame) const {
  CHECK_LE(0, frame);
  CHECK_LT(frame, frames());
  const auto f = static_cast<std::size_t>(frame);
  std::uint64_t d = stateDigest(&time_s[f], sizeof(double));
  for (const StructureTrack& s : structures) {
    d = stateDigest(s.name.data(), s.name.size(), d);
    d = addDigest(d, s.positions, frame);
    if (s.poses.empty()) continue;
    const Pose& p = s.poses[f];  // packed, because Pose has padding
    const double packed[7] = {p.q.w(), p.q.x(), p.q.y(), p.q.z(), p.t.x(), p.t.y(), p.t.z()};
    d = stateDigest(packed, sizeof packed, d);
  }
  d = addDigest(d, skin.positions, frame);
  d = addDigest(d, skin.velocities, frame);
  d = addDigest(d, skin.film_m, frame);
  d = addDigest(d, bolus.positions, frame);
  d = addDigest(d, bolus.velocities, frame);
  d = addDigest(d, bolus.densityRatio, frame);
  d = addDigest(d, bolus.state, frame);
  d = addDigest(d, bolus.region, frame);
  d = addDigest(d, bolus.s_m, frame);
  return addDigest(d, bolus.lentShare, frame);
}
}  // namespace swallowclip::frame
