// SPDX-License-Identifier: MIT
#include "verify/read_checks.h"

#include <cmath>

#include "verify/quantities.h"
#include "verify/references.h"

namespace swallowclip::verify {
namespace {
using scene::JsonNode;
constexpr double kMm = 1e-3;

QuantityDef readQuantity(const JsonNode& node) {
  QuantityDef q;
  q.kind = node.choice("kind", quantityNames());
  if (q.kind == "profile") {
    q.of = node.choice("of", fieldNames());
    q.along = node.choice("along", coordinateNames());
    q.bins = node.integer("bins", 2, 500, 0);
  } else if (node.has("along")) {
    q.along = node.choice("along", {"x", "y", "z"});
  }
  if (node.has("within")) {
    const JsonNode window = node.object("within");
    const char* keys[] = {"x_mm", "y_mm", "z_mm"};
    for (int k = 0; k < 3; ++k) {
      if (!window.has(keys[k])) continue;
      const std::vector<double> ends = window.numbers(keys[k]);
      if (ends.size() != 2 || !(ends[0] < ends[1]))
        window.fail(fmt::format("\"{}\" needs two rising numbers", keys[k]),
                    "Give [from, to] in millimetres.");
      else
        q.within_m[k] = {ends[0] * kMm, ends[1] * kMm};
    }
  }
  return q;
}

ReferenceDef readReference(const JsonNode& node) {
  ReferenceDef r;
  std::vector<std::string> known = referenceNames();
  known.insert(known.end(), {"table", "constant"});
  r.kind = node.choice("kind", known);
  r.place = node.place();
  if (r.kind == "constant") r.value = node.number("value", -1e12, 1e12);
  if (r.kind != "table") return r;
  const double xScale = node.number("x_scale", -1e12, 1e12, 1);
  const double yScale = node.number("y_scale", -1e12, 1e12, 1);
  for (const Vec2& p : node.points2("points"))
    r.points.emplace_back(p.x() * xScale, p.y() * yScale);
  if (node.exists() && r.points.size() < 2)
    node.fail("a table needs two points at least", "Add points, or use a constant.");
  for (std::size_t k = 1; k < r.points.size(); ++k)
    if (!(r.points[k].first > r.points[k - 1].first)) {
      node.fail(fmt::format("point {} of the table does not lie beyond the one before", k + 1),
                "Sort the points by their first number.");
      break;
    }
  return r;
}

ErrorRule errorRule(const std::string& word) {
  if (word == "rms") return ErrorRule::rms;
  if (word == "mean") return ErrorRule::mean;
  if (word == "each") return ErrorRule::each;
  return word == "absolute" ? ErrorRule::absolute : ErrorRule::max;
}
}  // namespace

std::vector<CheckDef> readChecks(const JsonNode& root) {
  std::vector<CheckDef> checks;
  for (const JsonNode& node : root.array("checks")) {
    CheckDef c;
    c.quantity = readQuantity(node.object("quantity"));
    c.reference = readReference(node.object("reference"));
    c.tolerance = node.number("tolerance", 1e-15, 1e6);
    c.error = errorRule(node.choice("error", {"max", "rms", "mean", "each", "absolute"}, "max"));
    c.from_s = node.number("from_s", 0, 1e4, 0);
    c.referenceError = node.number("reference_error", 0, c.tolerance, 0);
    if (node.has("align")) c.align = node.number("align", -1e12, 1e12);
    c.alignBest = node.boolean("align_best", false);
    if (c.align && c.alignBest)
      node.fail("\"align\" and \"align_best\" are both given", "Keep one of them.");
    if ((c.align || c.alignBest) && c.quantity.kind == "profile")
      node.fail("\"align\" is for series over time, this is a profile", "Remove \"align\".");
    const bool profileReference = referenceIsProfile(c.reference.kind);
    if (c.reference.kind != "table" && c.reference.kind != "constant" &&
        profileReference != (c.quantity.kind == "profile"))
      node.fail(fmt::format("reference \"{}\" is {}, quantity \"{}\" is not", c.reference.kind,
                            profileReference ? "a profile" : "a series over time", c.quantity.kind),
                "Choose a pair of the same sort; docs/verify.md lists them.");
    c.title = node.text("title", c.quantity.kind == "profile"
                                     ? fmt::format("{} along {}", c.quantity.of, c.quantity.along)
                                     : c.quantity.kind);
    checks.push_back(std::move(c));
  }
  if (root.exists() && checks.empty())
    root.fail("no checks: nothing would be compared", "Add one check at least.");
  return checks;
}
}  // namespace swallowclip::verify
