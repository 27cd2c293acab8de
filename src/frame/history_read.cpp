// SPDX-License-Identifier: MIT
// loadHistory: every shape is stated before it is believed.
#include <algorithm>
#include <cstring>
#include <sstream>

#include "frame/h5.h"
#include "frame/history_file.h"

namespace swallowclip::frame {
namespace {
using h5::kAny;
using h5::Shape;

/// Frames of a swallow at 30 to 120 frames/s; a quarter of an hour at the most. assumed, range
/// 10 000 to 1 000 000.
constexpr hsize_t kMostFrames = 100000;

template <class To, class From>
void copyInto(std::vector<To>& out, const From* first, std::size_t entries) {
  static_assert(sizeof(To) % sizeof(From) == 0);
  out.resize(entries);
  if (entries > 0)
    std::memcpy(static_cast<void*>(out.data()), static_cast<const void*>(first),
                entries * sizeof(To));
}

template <class To, class From>
Shape readList(h5::Reader& r, const std::string& path, const Shape& expected,
               std::vector<To>& out) {
  std::vector<From> flat;
  const Shape shape = r.data(path, expected, flat);
  if (!shape.empty()) copyInto(out, flat.data(), shape[0]);
  return shape;
}

template <class To, class From>
void readRows(h5::Reader& r, const std::string& path, const Shape& expected,
              std::vector<std::vector<To>>& out) {
  std::vector<From> flat;
  const Shape shape = r.data(path, expected, flat);
  if (shape.empty()) return;
  out.resize(shape[0]);
  const std::size_t row = flat.size() / std::max<std::size_t>(shape[0], 1);
  for (std::size_t f = 0; f < out.size(); ++f) copyInto(out[f], flat.data() + f * row, shape[1]);
}

std::vector<std::string> readNames(h5::Reader& r, const std::string& group) {
  std::vector<std::string> names;
  std::istringstream lines(r.text(group, "names"));
  for (std::string line; std::getline(lines, line);) names.push_back(line);
  return names;
}

void readMeta(h5::Reader& r, Meta& m) {
  m.version = r.whole("/meta", "version");
  if (r.fine() && m.version != kHistoryVersion)
    r.fail("/meta@version", fmt::format("version is {}, {} expected", m.version, kHistoryVersion));
  m.component = r.whole("/meta", "component");
  m.score = r.whole("/meta", "score");
  m.scene = r.text("/meta", "scene");
  m.swallow = r.text("/meta", "swallow");
  m.bolus = r.text("/meta", "bolus");
  m.solver = r.text("/meta", "solver");
  m.program = r.text("/meta", "program");
  m.inputsSha256 = r.text("/meta", "inputs_sha256");
  m.fps = r.number("/meta", "fps");
  m.cue_s = r.number("/meta", "cue_s");
  m.density_kgm3 = r.number("/meta", "density_kgm3");
  m.viscosity_Pas = r.number("/meta", "viscosity_Pas");
  constexpr double kUsual_kgm3 = 400;  // files older than this entry: the usual 40 % w/v
  m.bariumSulfate_kgm3 = r.number("/meta", "barium_sulfate_kgm3", kUsual_kgm3);
  m.particleSpacing_m = r.number("/meta", "particle_spacing_m");
  m.meanDensityError = r.number("/meta", "mean_density_error");
  m.maxDensityError = r.number("/meta", "max_density_error");
  m.shareAboveTenPercent = r.number("/meta", "share_above_ten_percent");
  m.maxSpeed_ms = r.number("/meta", "max_speed_ms");
  m.steps = std::llround(std::clamp(r.number("/meta", "steps"), 0.0, 1e15));
  m.velocityClamps = std::llround(std::clamp(r.number("/meta", "velocity_clamps"), 0.0, 1e15));
  r.data("/meta/cues_s", {kAny}, m.cues_s);
}

void readStructures(h5::Reader& r, History& h, hsize_t frames) {
  for (const std::string& name : readNames(r, "/structures")) {
    if (!r.fine()) return;
    const std::string group = "/structures/" + name;
    StructureTrack s;
    s.name = name;
    s.material = r.text(group, "material");
    const int rigid = r.whole(group, "rigid");
    if (rigid != 0 && rigid != 1) r.fail(group + "@rigid", "0 or 1 expected");
    s.rigid = rigid == 1;
    readList<Triangle, std::int32_t>(r, group + "/triangles", {kAny, 3}, s.triangles);
    readList<Vec3f, float>(r, group + "/rest", {kAny, 3}, s.rest);
    if (s.rigid) {
      std::vector<double> p;
      r.data(group + "/pose", {frames, 7}, p);
      for (std::size_t k = 0; k + 7 <= p.size(); k += 7)
        s.poses.push_back(
            {Quat(p[k], p[k + 1], p[k + 2], p[k + 3]), Vec3(p[k + 4], p[k + 5], p[k + 6])});
    } else {
      readRows<Vec3f, float>(r, group + "/positions", {frames, s.rest.size(), 3}, s.positions);
    }
    h.structures.push_back(std::move(s));
  }
}

void readSkin(h5::Reader& r, SkinTrack& s, hsize_t frames) {
  const Shape walls = readList<Wall, std::uint8_t>(r, "/skin/wall", {kAny}, s.wall);
  if (walls.empty()) return;
  const hsize_t vertices = walls[0];
  readList<Triangle, std::int32_t>(r, "/skin/triangles", {kAny, 3}, s.triangles);
  r.data("/skin/s_m", {vertices}, s.s_m);
  r.data("/skin/u", {vertices}, s.u);
  readRows<Vec3f, float>(r, "/skin/positions", {frames, vertices, 3}, s.positions);
  readRows<Vec3f, float>(r, "/skin/velocities", {frames, vertices, 3}, s.velocities);
  readRows<float, float>(r, "/skin/film_m", {kAny, s.triangles.size()}, s.film_m);
  if (vertices == 0) s.positions.clear(), s.velocities.clear(), s.film_m.clear();
}

void readBolus(h5::Reader& r, BolusTrack& b, hsize_t frames) {
  b.particleVolume_m3 = r.number("/bolus", "particle_volume_m3");
  std::vector<std::int32_t> id;
  const Shape ids = r.data("/bolus/id", {kAny}, id);
  if (ids.empty()) return;
  const hsize_t n = ids[0];
  for (hsize_t i = 0; i < n; ++i)
    if (static_cast<hsize_t>(id[i]) != i)
      return r.fail("/bolus/id", fmt::format("entry {} is {}, {} expected", i, id[i], i));
  readRows<Vec3f, float>(r, "/bolus/positions", {frames, n, 3}, b.positions);
  readRows<Vec3f, float>(r, "/bolus/velocities", {frames, n, 3}, b.velocities);
  readRows<float, float>(r, "/bolus/density_ratio", {frames, n}, b.densityRatio);
  readRows<float, float>(r, "/bolus/s_m", {frames, n}, b.s_m);
  readRows<ParticleState, std::uint8_t>(r, "/bolus/state", {frames, n}, b.state);
  readRows<Region, std::uint8_t>(r, "/bolus/region", {frames, n}, b.region);
  if (r.has("/bolus/lent_share"))
    readRows<float, float>(r, "/bolus/lent_share", {frames, n}, b.lentShare);
  if (n == 0) {
    const double volume_m3 = b.particleVolume_m3;
    b = {};
    b.particleVolume_m3 = volume_m3;
  }
}

void readTracks(h5::Reader& r, History& h, hsize_t frames) {
  const std::vector<std::string> names = readNames(r, "/landmarks");
  std::vector<float> p;
  r.data("/landmarks/positions", {frames, names.size(), 3}, p);
  if (!r.fine()) return;
  for (std::size_t l = 0; l < names.size(); ++l) {
    LandmarkTrack track{names[l], {}};
    for (std::size_t f = 0; f < frames; ++f) {
      const float* at = p.data() + (f * names.size() + l) * 3;
      track.positions.emplace_back(at[0], at[1], at[2]);
    }
    h.landmarks.push_back(std::move(track));
  }
  const std::vector<std::string> events = readNames(r, "/events");
  std::vector<double> times;
  r.data("/events/time_s", {events.size()}, times);
  for (std::size_t e = 0; r.fine() && e < events.size(); ++e)
    h.plannedEvents.push_back({events[e], times[e]});
  readList<LedgerRow, std::int32_t>(r, "/ledger", {kAny, 5}, h.ledger);
}
}  // namespace

Result<History> loadHistory(const std::filesystem::path& path) {
  History h;
  h5::Reader r(path.string());
  readMeta(r, h.meta);
  const Shape time = r.data("/time_s", {kAny}, h.time_s);
  const hsize_t frames = time.empty() ? 0 : time[0];
  if (r.fine() && (frames == 0 || frames > kMostFrames))
    r.fail("/time_s", fmt::format("{} frames, 1 to {} expected", frames, kMostFrames));
  readStructures(r, h, frames);
  readSkin(r, h.skin, frames);
  readBolus(r, h.bolus, frames);
  readTracks(r, h, frames);
  if (!r.fine()) return std::unexpected(r.error());
  if (const std::string fault = h.validate(); !fault.empty())
    return usageError(path.string(), "holds unsound values: " + fault,
                      "Simulate again to write a fresh history.");
  return h;
}
}  // namespace swallowclip::frame
