// SPDX-License-Identifier: MIT
#include <algorithm>

#include "library/clip_check.h"
#include "library/report.h"
#include "video/png.h"

namespace swallowclip::library {
namespace fs = std::filesystem;
namespace {
/// "v_mm_per_s 140 -> 146", values that differ at six digits (as many as measures.json has).
std::vector<std::string> movedValues(const Measured& before, const Measured& now) {
  std::vector<std::string> moved;
  const auto text = [](const std::map<std::string, double>& all, const std::string& name) {
    const auto at = all.find(name);
    return at == all.end() ? std::string("none") : fmt::format("{:.6g}", at->second);
  };
  std::map<std::string, double> names = before.quantities;
  names.insert(now.quantities.begin(), now.quantities.end());
  for (const auto& [name, value] : names)
    if (const auto a = text(before.quantities, name), b = text(now.quantities, name); a != b)
      moved.push_back(fmt::format("{} {} -> {}", name, a, b));
  for (const auto& [component, score] : now.scores)
    if (const auto old = before.scores.find(component);
        old != before.scores.end() && old->second != score)
      moved.push_back(fmt::format("score of component {} {} -> {}", component, old->second, score));
  return moved;
}

const StoredFile* fileOf(const NightClip& clip, const std::string& kind) {
  const std::string path = nightPath(clip, kind);
  for (const StoredFile& f : clip.files)
    if (f.name == path) return &f;
  return nullptr;
}

bool sameFile(const NightClip& a, const NightClip& b, const std::string& kind) {
  const StoredFile *x = fileOf(a, kind), *y = fileOf(b, kind);
  return x && y && x->sha256 == y->sha256;
}
}  // namespace

std::vector<Change> changesSince(const std::optional<Night>& last, const Night& now,
                                 const Plan& plan, const Root& root) {
  std::vector<Change> changes;
  if (!last) return changes;  // a first night has nothing to differ from
  for (const PlannedClip& planned : plan.clips) {
    const NightClip* clip = now.find(planned.name);
    const NightClip* before = last->find(planned.name);
    if (!clip) continue;
    Change change{planned.name, !before, 0, {}};
    if (before) {
      const bool sameLook = sameFile(*before, *clip, ".mp4");
      if (sameLook && sameFile(*before, *clip, ".json")) continue;
      const fs::path folder = root.nights() / last->name;
      if (!sameLook) {
        const auto a = video::readPng(folder / nightPath(*before, "sheet"));
        const auto b =
            video::readPng(root.product(plan.jobs[planned.jobs[4]].job.key) / "sheet.png");
        change.difference = a && b ? visibleDifference(*a, *b) : 1;
      }
      if (const auto measured = readMeasured(folder / nightPath(*before, ".json")))
        change.moved = movedValues(*measured, clip->measured);
    }
    changes.push_back(std::move(change));
  }
  std::ranges::stable_sort(
      changes, [](const Change& a, const Change& b) { return a.difference > b.difference; });
  return changes;
}
}  // namespace swallowclip::library
