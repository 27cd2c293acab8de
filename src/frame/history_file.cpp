// SPDX-License-Identifier: MIT
#include "frame/history_file.h"

#include <type_traits>

#include "core/file.h"
#include "frame/h5.h"

namespace swallowclip::frame {
namespace {
namespace fs = std::filesystem;
using h5::Shape;

/// Any list of small fixed-size entries (vectors, triangles, enums) as plain numbers.
template <class To, class From>
void append(std::vector<To>& flat, const std::vector<From>& list) {
  static_assert(std::is_trivially_destructible_v<From> && sizeof(From) % sizeof(To) == 0);
  const auto* first = reinterpret_cast<const To*>(list.data());
  flat.insert(flat.end(), first, first + list.size() * (sizeof(From) / sizeof(To)));
}

template <class To, class From>
std::vector<To> flatten(const std::vector<From>& list) {
  std::vector<To> flat;
  append(flat, list);
  return flat;
}

template <class To, class From>
std::vector<To> flatten(const std::vector<std::vector<From>>& rows) {
  std::vector<To> flat;
  if (!rows.empty()) flat.reserve(rows.size() * rows[0].size() * (sizeof(From) / sizeof(To)));
  for (const auto& row : rows) append(flat, row);
  return flat;
}

template <class List>
std::string joinNames(const List& list) {
  std::string names;
  for (const auto& entry : list) names += (names.empty() ? "" : "\n") + entry.name;
  return names;
}

void writeMeta(h5::Writer& w, const Meta& m) {
  w.group("/meta");
  w.whole("/meta", "version", m.version);
  w.whole("/meta", "component", m.component);
  w.whole("/meta", "score", m.score);
  w.text("/meta", "scene", m.scene);
  w.text("/meta", "swallow", m.swallow);
  w.text("/meta", "bolus", m.bolus);
  w.text("/meta", "solver", m.solver);
  w.text("/meta", "program", m.program);
  w.text("/meta", "inputs_sha256", m.inputsSha256);
  w.text("/meta", "units", "m, s, kg; x left, y posterior, z superior");
  w.number("/meta", "fps", m.fps);
  w.number("/meta", "cue_s", m.cue_s);
  w.number("/meta", "density_kgm3", m.density_kgm3);
  w.number("/meta", "viscosity_Pas", m.viscosity_Pas);
  w.number("/meta", "barium_sulfate_kgm3", m.bariumSulfate_kgm3);
  w.number("/meta", "particle_spacing_m", m.particleSpacing_m);
  w.number("/meta", "mean_density_error", m.meanDensityError);
  w.number("/meta", "max_density_error", m.maxDensityError);
  w.number("/meta", "share_above_ten_percent", m.shareAboveTenPercent);
  w.number("/meta", "max_speed_ms", m.maxSpeed_ms);
  w.number("/meta", "steps", static_cast<double>(m.steps));
  w.number("/meta", "velocity_clamps", static_cast<double>(m.velocityClamps));
  w.data("/meta/cues_s", {m.cues_s.size()}, m.cues_s);
}

void writeStructures(h5::Writer& w, const History& h) {
  w.group("/structures");
  w.text("/structures", "names", joinNames(h.structures));
  const hsize_t frames = h.time_s.size();
  for (const StructureTrack& s : h.structures) {
    const std::string group = "/structures/" + s.name;
    w.group(group);
    w.text(group, "material", s.material);
    w.whole(group, "rigid", s.rigid ? 1 : 0);
    w.data(group + "/triangles", {s.triangles.size(), 3}, flatten<std::int32_t>(s.triangles));
    w.data(group + "/rest", {s.rest.size(), 3}, flatten<float>(s.rest));
    if (!s.rigid) {
      w.data(group + "/positions", {frames, s.rest.size(), 3}, flatten<float>(s.positions));
      continue;
    }
    std::vector<double> poses;
    for (const Pose& p : s.poses)
      poses.insert(poses.end(), {p.q.w(), p.q.x(), p.q.y(), p.q.z(), p.t.x(), p.t.y(), p.t.z()});
    w.data(group + "/pose", {frames, 7}, poses);
  }
}

void writeSkin(h5::Writer& w, const SkinTrack& s, hsize_t frames) {
  const hsize_t vertices = s.wall.size();
  w.group("/skin");
  w.data("/skin/triangles", {s.triangles.size(), 3}, flatten<std::int32_t>(s.triangles));
  w.data("/skin/wall", {vertices}, flatten<std::uint8_t>(s.wall));
  w.data("/skin/s_m", {vertices}, s.s_m);
  w.data("/skin/u", {vertices}, s.u);
  w.data("/skin/positions", {frames, vertices, 3}, flatten<float>(s.positions));
  w.data("/skin/velocities", {frames, vertices, 3}, flatten<float>(s.velocities));
  w.data("/skin/film_m", {s.film_m.size(), s.triangles.size()}, flatten<float>(s.film_m));
}

void writeBolus(h5::Writer& w, const BolusTrack& b, hsize_t frames) {
  w.group("/bolus");
  w.number("/bolus", "particle_volume_m3", b.particleVolume_m3);
  const hsize_t particles = b.positions.empty() ? 0 : b.positions[0].size();
  std::vector<std::int32_t> id(particles);
  for (std::size_t i = 0; i < id.size(); ++i) id[i] = static_cast<std::int32_t>(i);
  w.data("/bolus/id", {particles}, id);
  w.data("/bolus/positions", {frames, particles, 3}, flatten<float>(b.positions));
  w.data("/bolus/velocities", {frames, particles, 3}, flatten<float>(b.velocities));
  w.data("/bolus/density_ratio", {frames, particles}, flatten<float>(b.densityRatio));
  w.data("/bolus/s_m", {frames, particles}, flatten<float>(b.s_m));
  w.data("/bolus/state", {frames, particles}, flatten<std::uint8_t>(b.state));
  w.data("/bolus/region", {frames, particles}, flatten<std::uint8_t>(b.region));
  if (!b.lentShare.empty())
    w.data("/bolus/lent_share", {frames, particles}, flatten<float>(b.lentShare));
}

void writeTracks(h5::Writer& w, const History& h) {
  const hsize_t frames = h.time_s.size();
  w.group("/landmarks");
  w.text("/landmarks", "names", joinNames(h.landmarks));
  std::vector<float> positions;
  for (std::size_t f = 0; f < frames; ++f)
    for (const LandmarkTrack& l : h.landmarks)
      positions.insert(positions.end(), l.positions[f].data(), l.positions[f].data() + 3);
  w.data("/landmarks/positions", {frames, h.landmarks.size(), 3}, positions);

  w.group("/events");
  w.text("/events", "names", joinNames(h.plannedEvents));
  std::vector<double> times;
  for (const Event& e : h.plannedEvents) times.push_back(e.time_s);
  w.data("/events/time_s", {times.size()}, times);

  w.data("/ledger", {h.ledger.size(), 5}, flatten<std::int32_t>(h.ledger));
}

std::expected<std::string, std::string> build(const History& h) {
  h5::Writer w;
  writeMeta(w, h.meta);
  w.data("/time_s", {h.time_s.size()}, h.time_s);
  writeStructures(w, h);
  writeSkin(w, h.skin, h.time_s.size());
  writeBolus(w, h.bolus, h.time_s.size());
  writeTracks(w, h);
  return w.finish();
}
}  // namespace

Result<void> saveHistory(const History& history, const fs::path& path) {
  if (const std::string fault = history.validate(); !fault.empty())
    return failure(path.string(), "not saved, the history is not sound: " + fault,
                   "This is a fault of the simulation; report it with the command used.");
  std::expected<std::string, std::string> bytes = build(history);
  if (!bytes)
    return failure(path.string(), bytes.error(),
                   "Free memory, shorten names, or use fewer particles (--spacing-mm).");
  if (auto written = writeFile(path, *bytes); !written) return written;
  fs::path side = path;
  side.replace_extension(".xdmf");
  return writeFile(side, xdmfText(history, path.filename().string()));
}
}  // namespace swallowclip::frame
