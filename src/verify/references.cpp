// SPDX-License-Identifier: MIT
#include "verify/references.h"

#include <memory>

#include "verify/formulas.h"

namespace swallowclip::verify {
namespace {
/// Not a number beyond the ends of the table: nothing is known there.
double readTable(const std::vector<std::pair<double, double>>& points, double x) {
  if (x < points.front().first) return NAN;
  for (std::size_t k = 1; k < points.size(); ++k) {
    const auto [x0, y0] = points[k - 1];
    const auto [x1, y1] = points[k];
    if (x <= x1) return y0 + (y1 - y0) * (x - x0) / (x1 - x0);
  }
  return NAN;
}

const Formula* findFormula(const std::string& name) {
  for (const Formula& row : formulas())
    if (name == row.name) return &row;
  return nullptr;
}
}  // namespace

std::vector<std::string> referenceNames() {
  std::vector<std::string> names;
  for (const Formula& row : formulas()) names.emplace_back(row.name);
  return names;
}

bool referenceIsProfile(const std::string& name) {
  const Formula* row = findFormula(name);
  return row && row->profile;
}

Result<Reference> makeReference(const CaseDef& def, const ReferenceDef& reference) {
  if (reference.kind == "constant")
    return Reference([value = reference.value](const Probe&) { return value; });
  if (reference.kind == "table")
    return Reference(
        [points = reference.points](const Probe& p) { return readTable(points, p.along); });
  const Formula* row = findFormula(reference.kind);
  if (!row)
    return usageError(reference.place, fmt::format("unknown reference \"{}\"", reference.kind),
                      fmt::format("Known: {}.", fmt::join(referenceNames(), ", ")));
  for (const Need& need : row->needs)
    if (!need.met(def))
      return usageError(reference.place,
                        fmt::format("reference \"{}\" needs {}", reference.kind, need.text),
                        "Change the case, or compare with a table.");
  auto setting = std::make_shared<Setting>(Setting{def, {}, {}, Vec3::Zero(), 0});
  auto domain = Domain::build(setting->def, def.spacing_m);
  if (!domain) return std::unexpected(domain.error());
  setting->domain = *domain;
  auto start = fillDomain(setting->def, setting->domain, def.spacing_m);
  if (!start) return std::unexpected(start.error());
  setting->start = *start;
  for (const Vec3& p : setting->start.positions)
    setting->middle_m += setting->domain.fromWorld(p) / double(setting->start.positions.size());
  if (reference.kind == "hydrostatic")
    setting->level_m = setting->domain.level_m(setting->volume(), setting->up());
  return Reference([setting, row](const Probe& p) { return row->value(*setting, p); });
}
}  // namespace swallowclip::verify
