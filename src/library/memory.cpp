// SPDX-License-Identifier: MIT
#include <algorithm>
#include <sstream>

#include "core/digest.h"
#include "core/file.h"
#include "library/plan.h"

namespace swallowclip::library {
namespace {
/// Seconds before anything was measured, by stage: 480p, 2 mm, docs/nightly.md.
constexpr double kGuess_s[] = {2, 60, 1, 15, 2};
constexpr std::size_t kShort = 12;  // digits of a digest that only tells "changed"

/// "product" lines differ whenever something before them did; the other lines say what.
bool isInput(const std::string& what) {
  return what != "product";
}
}  // namespace

std::map<std::string, std::string> Memory::digested(const Job& job) {
  std::map<std::string, std::string> all;
  for (const RecipeLine& line : job.recipe)
    all[line.what] = sha256Hex(all[line.what] + line.value).substr(0, kShort);
  return all;
}

// Lines "NAME \t what \t digest" and "NAME \t \t cost"; a line that can't be read is left out,
// which costs a "why" and an estimate.
Memory::Memory(std::filesystem::path file) : file_(std::move(file)) {
  for (const auto& c : readTable(file_)) {
    if (c.size() != 3) continue;
    Entry& entry = entries_[c[0]];
    if (c[1].empty())
      std::istringstream(c[2]) >> entry.cost_s;
    else
      entry.recipe[c[1]] = c[2];
  }
}

std::string Memory::changes(const Job& job) const {
  const auto at = entries_.find(job.name);
  if (at == entries_.end()) return "";
  const auto now = digested(job);
  std::string inputs;
  bool products = false;
  const auto note = [&](const std::string& what) {
    if (isInput(what))
      inputs += (inputs.empty() ? "" : ", ") + what + " changed";
    else
      products = true;
  };
  for (const auto& [what, digest] : now)
    if (const auto old = at->second.recipe.find(what);
        old == at->second.recipe.end() || old->second != digest)
      note(what);
  for (const auto& [what, digest] : at->second.recipe)
    if (!now.contains(what)) note(what);
  return inputs.empty() && products ? "made from products that changed" : inputs;
}

double Memory::cost_s(const Job& job) const {
  if (const auto at = entries_.find(job.name); at != entries_.end() && at->second.cost_s > 0)
    return at->second.cost_s;
  double sum_s = 0;
  int count = 0;
  const std::string stage = std::string(name(job.stage)) + " ";
  for (auto at = entries_.lower_bound(stage); at != entries_.end() && at->first.starts_with(stage);
       ++at)
    if (at->second.cost_s > 0) {
      sum_s += at->second.cost_s;
      ++count;
    }
  return count > 0 ? sum_s / count : kGuess_s[static_cast<int>(job.stage)];
}

void Memory::keep(const Plan& plan) {
  std::map<std::string, Entry> kept;
  for (const PlannedJob& p : plan.jobs) {
    Entry& entry = kept[p.job.name];
    entry.recipe = digested(p.job);
    if (p.marker)
      entry.cost_s = p.marker->cpu_s;
    else if (const auto old = entries_.find(p.job.name); old != entries_.end())
      entry.cost_s = old->second.cost_s;
  }
  entries_ = std::move(kept);
}

Result<void> Memory::save() const {
  std::string text;
  for (const auto& [job, entry] : entries_) {
    for (const auto& [what, digest] : entry.recipe)
      text += fmt::format("{}\t{}\t{}\n", job, what, digest);
    if (entry.cost_s > 0) text += fmt::format("{}\t\t{:.3f}\n", job, entry.cost_s);
  }
  return writeFile(file_, text);
}
}  // namespace swallowclip::library
