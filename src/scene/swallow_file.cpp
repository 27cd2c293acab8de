// SPDX-License-Identifier: MIT
#include "scene/swallow_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "scene/curves.h"

namespace swallowclip::scene {
namespace {
using kinematics::SwallowDef;
using kinematics::Track;
constexpr int kMaxBases = 4;
constexpr double kMostGravity_ms2 = 20;

struct TrackKey {
  const char* name;
  double Track::*field;
  double min, max;
};
constexpr double kTime = 60;
const std::vector<TrackKey>& trackKeys() {
  static const std::vector<TrackKey> keys{
      {"onset_s", &Track::onset_s, -kTime, kTime}, {"peak_s", &Track::peak_s, -kTime, kTime},
      {"hold_s", &Track::hold_s, -kTime, kTime},   {"offset_s", &Track::offset_s, -kTime, kTime},
      {"amplitude", &Track::amplitude, -2, 3},     {"delay_s", &Track::delay_s, -kTime, kTime},
      {"speed", &Track::speed, 0.05, 20}};
  return keys;
}

/// What people name together when they speak of timing.
struct Group {
  std::string name;
  std::vector<std::string> tracks;
};
const std::vector<Group> kGroups{
    {"larynx", {"larynx_superior", "larynx_anterior", "arytenoid", "epiglottis", "vocal_folds"}},
    {"hyoid", {"hyoid_superior", "hyoid_anterior"}}};

bool ordered(const Track& t) {
  return t.onset_s <= t.peak_s && t.peak_s <= t.hold_s && t.hold_s <= t.offset_s;
}

void readTracks(const JsonNode& j, SwallowDef& d) {
  if (!j.has("tracks")) return;
  const auto& kinds = kinematics::trackKinds();
  for (const auto& [name, node] : j.object("tracks").members()) {
    const auto kind =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.name == name; });
    if (kind == kinds.end()) {
      std::vector<std::string> known;
      for (const auto& k : kinds) known.push_back(k.name);
      const std::string near = nearestName(name, known);
      node.fail(
          fmt::format("unknown track '{}'", name),
          near.empty() ? "See docs for the tracks." : fmt::format("Did you mean '{}'?", near));
      continue;
    }
    Track& t = d.tracks[name];
    for (const TrackKey& key : trackKeys())
      t.*key.field = node.number(key.name, key.min, key.max, t.*key.field);
    if (kind->length)
      t.peakValue =
          node.number("peak_mm", 0, 60, t.peakValue == 1 ? 0 : t.peakValue / kMetrePerMm) *
          kMetrePerMm;
    else
      t.peakValue = node.number("peak", 0, 1, t.peakValue);
    if (!ordered(t))
      node.fail("onset_s <= peak_s <= hold_s <= offset_s does not hold", "Sort the four times.");
  }
}

void readHollows(const JsonNode& j, SwallowDef& d) {
  if (!j.has("hollows")) return;
  d.hollows.clear();
  for (const JsonNode& h : j.array("hollows")) {
    kinematics::Hollow one;
    one.start_m = h.number("start_mm", 0, 80) * kMetrePerMm;
    one.end_m = h.number("end_mm", 0, 80) * kMetrePerMm;
    one.centre_m = h.number("centre_mm", -18, 18, 0) * kMetrePerMm;
    one.halfWidth_m = h.number("half_width_mm", 1, 18) * kMetrePerMm;
    one.depth_m = h.number("depth_mm", 0, 15) * kMetrePerMm;
    if (h.exists() && one.end_m - one.start_m < 3e-3)
      h.fail("'end_mm' must be at least 3 mm beyond 'start_mm'", "s counts from the incisors.");
    d.hollows.push_back(one);
  }
}

Result<SwallowDef> load(const std::filesystem::path& path, int depth) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  const JsonNode j = file->root();
  SwallowDef d;
  if (j.has("base")) {
    const std::string base = j.text("base");
    if (depth >= kMaxBases) {
      j.member("base").fail("files are based on each other too deeply or in a circle",
                            "Base it on normal.json.");
    } else if (!base.empty()) {
      auto parent = load(path.parent_path() / base, depth + 1);
      if (!parent) return parent;
      d = std::move(*parent);
    }
  }
  d.name = path.stem().string();
  d.title = j.text("title", d.title);
  d.component = j.integer("component", 0, 17, d.component);
  d.score = j.integer("score", -1, 4, d.score);
  d.duration_s = j.number("duration_s", 0.5, kTime, d.duration_s);
  d.bpm_s = j.number("planned_bpm_s", 0, kTime, d.bpm_s);
  if (j.has("cues_s")) d.cues_s = j.numbers("cues_s");
  if (d.cues_s.empty() || d.cues_s.front() != 0)
    j.fail("'cues_s' must begin with 0", "Time 0 is the cue.");
  if (j.has("front_s_mm")) d.front_m = readCurve(j, "front_s_mm", 1, kMetrePerMm);
  d.frontAmplitude = j.number("front_amplitude", 0, 1, d.frontAmplitude);
  d.gravity_ms2 = j.vec3("gravity_ms2", d.gravity_ms2);
  if (d.gravity_ms2.norm() > kMostGravity_ms2)
    j.member("gravity_ms2")
        .fail("more than twice the earth's gravity",
              "Upright it is [0, 0, -9.81], lying on the back [0, 9.81, 0].");
  d.roomFactor = j.number("room_factor", 1.1, 1.6, d.roomFactor);
  d.grooveStart_m = j.number("groove_start_mm", 0, 40, d.grooveStart_m / kMetrePerMm) * kMetrePerMm;
  d.grooveEnd_m = j.number("groove_end_mm", 25, 70, d.grooveEnd_m / kMetrePerMm) * kMetrePerMm;
  d.grooveHalfWidth_m =
      j.number("groove_half_width_mm", 6, 15, d.grooveHalfWidth_m / kMetrePerMm) * kMetrePerMm;
  d.rockAmplitude_m =
      j.number("rock_amplitude_mm", 0, 20, d.rockAmplitude_m / kMetrePerMm) * kMetrePerMm;
  d.rockRate_hz = j.number("rock_rate_hz", 0.1, 5, d.rockRate_hz);
  d.rockCycles = j.integer("rock_cycles", 0, 20, static_cast<int>(d.rockCycles));
  d.rockStart_s = j.number("rock_start_s", 0, kTime, d.rockStart_s);
  readTracks(j, d);
  readHollows(j, d);
  const double delay = j.number("later_delay_s", -2, kTime, 0);
  if (delay != 0)
    for (auto& [name, track] : d.tracks)
      if (name != "chute") track.delay_s += delay;
  if (d.front_m.empty())
    j.fail("no 'front_s_mm', neither here nor in a base", "Add the contact front.");
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return d;
}
}  // namespace

Result<SwallowDef> loadSwallow(const std::filesystem::path& path) {
  return load(path, 0);
}

Result<std::vector<std::filesystem::path>> swallowFiles(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files{path};
  while (static_cast<int>(files.size()) <= kMaxBases) {
    auto file = JsonFile::load(files.back());
    if (!file) return std::unexpected(file.error());
    const JsonNode root = file->root();
    if (!root.isObject() || !root.has("base")) break;
    files.push_back(files.back().parent_path() / root.text("base"));
  }
  return files;
}

Result<void> applySet(SwallowDef& swallow, const std::string& assignment) {
  const auto dot = assignment.find('.'), equal = assignment.find('=');
  if (dot == std::string::npos || equal == std::string::npos || equal < dot)
    return usageError("--set " + assignment, "is not of the form track.key=value",
                      "For example --set velum.onset_s=0.4");
  const std::string track = assignment.substr(0, dot),
                    key = assignment.substr(dot + 1, equal - dot - 1);
  std::vector<std::string> tracks, keys, members{track};
  for (const auto& k : kinematics::trackKinds()) tracks.push_back(k.name);
  for (const Group& g : kGroups) {
    tracks.push_back(g.name);
    if (track == g.name) members = g.tracks;
  }
  for (const auto& k : trackKeys()) keys.push_back(k.name);
  const auto unknown = [&](const std::string& what, const std::string& word,
                           const std::vector<std::string>& known) {
    const std::string near = nearestName(word, known);
    return usageError("--set " + assignment, fmt::format("unknown {} '{}'", what, word),
                      near.empty() ? fmt::format("Known: {}.", fmt::join(known, ", "))
                                   : fmt::format("Did you mean '{}'?", near));
  };
  if (std::find(tracks.begin(), tracks.end(), track) == tracks.end())
    return unknown("track", track, tracks);
  const auto it = std::find_if(trackKeys().begin(), trackKeys().end(),
                               [&](const TrackKey& k) { return k.name == key; });
  if (it == trackKeys().end()) return unknown("key", key, keys);
  double value = 0;
  const char* end = assignment.data() + assignment.size();
  const auto [p, ec] = std::from_chars(assignment.data() + equal + 1, end, value);
  if (ec != std::errc() || p != end || !std::isfinite(value) || value < it->min || value > it->max)
    return usageError("--set " + assignment,
                      fmt::format("the value must be a number in [{}, {}]", it->min, it->max),
                      "Correct it.");
  if (members.size() > 1 && it->field != &Track::amplitude && it->field != &Track::delay_s &&
      it->field != &Track::speed)
    return usageError("--set " + assignment,
                      fmt::format("'{}' moves several tracks ({}), each with times of its own",
                                  track, fmt::join(members, ", ")),
                      "Give its amplitude, delay_s or speed, or name one of the tracks.");
  for (const std::string& name : members) {
    Track& t = swallow.tracks[name];
    // A motion that begins at another time is the same motion at another time.
    if (it->field == &Track::onset_s)
      for (double Track::*time : {&Track::peak_s, &Track::hold_s, &Track::offset_s})
        t.*time += value - t.onset_s;
    t.*(it->field) = value;
    if (!ordered(t))
      return usageError("--set " + assignment,
                        "onset_s <= peak_s <= hold_s <= offset_s no longer holds",
                        "Move the other times too.");
  }
  return {};
}
}  // namespace swallowclip::scene
