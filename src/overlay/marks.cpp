// SPDX-License-Identifier: MIT
#include "overlay/marks.h"

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "overlay/marks_csv.h"
#include "scene/json_reader.h"

namespace swallowclip::overlay {
namespace {
constexpr const char* kPlace = "events file";
constexpr double kFar_px = 8192;  // longest side of a study
constexpr double kSameSpot_px = 1;

/// a is never later than b. Others may come in any order (BPM and HYB, LVC and UESO do).
constexpr std::pair<const char*, const char*> kOrder[] = {
    {"tongue_onset", "BPM"}, {"BPM", "UESC"},    {"HYB", "SwRest"}, {"LVC", "LVCoff"},
    {"UESO", "UESMax"},      {"UESMax", "UESC"}, {"UESO", "UESC"},  {"MPC", "SwRest"},
    {"LVCoff", "SwRest"},    {"BPM", "SwRest"},  {"HYB", "LVCoff"}, {"tongue_onset", "SwRest"}};

std::string lower(std::string word) {
  std::ranges::transform(word, word.begin(), [](unsigned char c) {
    return c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(c));
  });
  return word;
}

/// A message without the excerpt of the file's text that the JSON reader adds.
Error withoutExcerpt(Error error) {
  error.problem = error.problem.substr(0, error.problem.find('\n'));
  return error;
}

Result<Marks> readJson(const std::string& text) {
  auto file = scene::JsonFile::parse(text, kPlace);
  if (!file) return std::unexpected(withoutExcerpt(file.error()));
  const scene::JsonNode j = file->root();
  Marks marks;
  j.number("version", 1, 1);
  marks.facesRight = j.choice("facing", {"left", "right"}, "left") == "right";
  if (j.choice("scale", {"landmarks", "calibration"}, "landmarks") == "calibration")
    marks.scale = ScaleFrom::calibration;
  std::optional<Error> error;
  const auto keep = [&](const auto& result) {
    if (!result && !error) error = result.error();
    return result.has_value();
  };
  for (const auto& [key, node] : j.object("events").members()) {
    const auto name = knownName(key, eventNames(), "event", node.place());
    const double frame = node.asNumber(0, 1e6);
    if (frame != std::floor(frame)) node.fail("a whole frame number expected", "Correct it.");
    if (keep(name)) marks.events.push_back({*name, static_cast<int>(frame)});
  }
  if (j.has("landmarks"))
    for (const scene::JsonNode& node : j.array("landmarks")) {
      MarkedPoint point;
      const auto name = knownName(node.text("name"), landmarkNames(), "landmark", node.place());
      if (keep(name)) point.name = *name;
      if (node.has("frame")) point.frame = node.integer("frame", 0, 1000000);
      point.at_px = {node.number("x_px", -kFar_px, kFar_px),
                     node.number("y_px", -kFar_px, kFar_px)};
      marks.points.push_back(point);
    }
  if (j.has("calibration")) {
    const scene::JsonNode c = j.object("calibration");
    const auto end = [&](const char* key) {
      const std::vector<double> xy = c.numbers(key);
      if (xy.size() == 2) return Vec2(xy[0], xy[1]);
      c.fail(fmt::format("'{}' must be [x, y]", key), "Correct it.");
      return Vec2(0, 0);
    };
    marks.calibration =
        Calibration{end("from_px"), end("to_px"), c.number("length_mm", 1, 500) * kMetrePerMm};
  }
  if (auto done = file->finish(); !done) return std::unexpected(withoutExcerpt(done.error()));
  if (error) return std::unexpected(*error);
  return marks;
}
}  // namespace

Result<std::string> knownName(const std::string& word, const std::vector<std::string>& known,
                              const char* what, const std::string& place) {
  for (const std::string& name : known)
    if (lower(name) == lower(word)) return name;
  const std::string near = nearestName(word, known);
  return usageError(place, fmt::format("an unknown {}", what),
                    near.empty() ? fmt::format("Known: {}.", fmt::join(known, ", "))
                                 : fmt::format("Did you mean \"{}\"?", near));
}

const std::vector<std::string>& eventNames() {
  static const std::vector<std::string> names{"tongue_onset", "BPM", "HYB",  "LVC",    "UESO",
                                              "UESMax",       "MPC", "UESC", "LVCoff", "SwRest"};
  return names;
}

const std::vector<LandmarkKind>& landmarkKinds() {
  static const std::vector<LandmarkKind> kinds{
      {"C2_anterior_inferior", true},
      {"C2_posterior_inferior", true},
      {"C3_anterior_superior", true},
      {"C3_anterior_inferior", true},
      {"C3_posterior_inferior", true},
      {"C4_anterior_inferior", true},
      {"C4_posterior_inferior", true},
      {"C5_anterior_inferior", true},
      {"C5_posterior_inferior", true},
      {"C6_anterior_inferior", true},
      {"C6_posterior_inferior", true},
      {"ANS", true},
      {"PNS", true},
      {"upper_incisor_tip", true},
      {"lower_incisor_tip", false},
      {"menton", false},
      {"pogonion", false},
      {"hyoid_body_centre", false},
      {"hyoid_body_anterior_superior", false},
      {"hyoid_body_anterior_inferior", false},
      {"laryngeal_prominence", false},
      {"cricoid_arch_inferior", false},
  };
  return kinds;
}

std::vector<std::string> landmarkNames() {
  std::vector<std::string> names;
  for (const LandmarkKind& k : landmarkKinds()) names.emplace_back(k.name);
  return names;
}

namespace {
Result<Marks> checkedMarks(Marks marks, const study::StudyInfo& study) {
  const auto refuse = [](const std::string& problem, const std::string& remedy) {
    return usageError(kPlace, problem, remedy);
  };
  if (marks.events.empty())
    return refuse("no event is marked", "Mark at least one, e.g. BPM, with its frame.");
  std::ranges::stable_sort(marks.events, {}, &StudyEvent::frame);
  for (std::size_t i = 0; i < marks.events.size(); ++i) {
    const StudyEvent& e = marks.events[i];
    if (e.frame < 0 || e.frame >= study.frames())
      return refuse(fmt::format("{} at frame {}, the study has frames 0 to {}", e.name, e.frame,
                                study.frames() - 1),
                    "Take the number from a contact sheet (`swallowclip events`).");
    for (std::size_t k = 0; k < i; ++k)
      if (marks.events[k].name == e.name)
        return refuse(fmt::format("{} is marked twice, at frames {} and {}", e.name,
                                  marks.events[k].frame, e.frame),
                      "Keep one.");
  }
  const auto frameOf = [&](const char* name) -> std::optional<int> {
    for (const StudyEvent& e : marks.events)
      if (e.name == name) return e.frame;
    return std::nullopt;
  };
  for (const auto& [first, second] : kOrder) {
    const auto a = frameOf(first), b = frameOf(second);
    if (a && b && *a > *b)
      return refuse(fmt::format("{} at frame {} comes after {} at frame {}", first, *a, second, *b),
                    "They can only come in the other order: correct one of them.");
  }
  for (std::size_t i = 0; i < marks.points.size(); ++i) {
    const MarkedPoint& p = marks.points[i];
    const std::string when = p.frame ? fmt::format(" at frame {}", *p.frame) : "";
    if (p.frame && (*p.frame < 0 || *p.frame >= study.frames()))
      return refuse(
          fmt::format("{}{}, the study has frames 0 to {}", p.name, when, study.frames() - 1),
          "Take the number from a contact sheet (`swallowclip events`).");
    if (!(p.at_px.x() >= 0 && p.at_px.x() <= study.width && p.at_px.y() >= 0 &&
          p.at_px.y() <= study.height))
      return refuse(fmt::format("{}{} at {:.1f}, {:.1f} lies outside the picture of {} x {}",
                                p.name, when, p.at_px.x(), p.at_px.y(), study.width, study.height),
                    "Count pixels of the study from its upper left corner.");
    for (std::size_t k = 0; k < i; ++k) {
      const MarkedPoint& q = marks.points[k];
      if (q.frame != p.frame) continue;
      if (q.name == p.name)
        return refuse(fmt::format("{} is marked twice{}", p.name, when), "Keep one.");
      if ((q.at_px - p.at_px).norm() < kSameSpot_px)
        return refuse(fmt::format("{} and {} lie on one spot{}", q.name, p.name, when),
                      "Correct one of them.");
    }
  }
  if (marks.calibration && (marks.calibration->from_px - marks.calibration->to_px).norm() < 4)
    return refuse("the ends of the calibration object lie less than 4 pixels apart",
                  "Mark both ends.");
  if (marks.scale == ScaleFrom::calibration && !marks.calibration)
    return refuse("scale \"calibration\" without a calibration object", "Add one.");
  return marks;
}
}  // namespace

Result<Marks> loadMarks(const std::filesystem::path& path, const study::StudyInfo& study) {
  auto text = readFile(path);
  if (!text) {
    text.error().place = kPlace;
    return std::unexpected(text.error());
  }
  const std::size_t first = text->find_first_not_of(" \t\r\n\xef\xbb\xbf");
  const bool json = first != std::string::npos && (*text)[first] == '{';
  auto marks = json ? readJson(*text) : readCsv(*text);
  if (!marks) return marks;
  return checkedMarks(std::move(*marks), study);
}
}  // namespace swallowclip::overlay
