// SPDX-License-Identifier: MIT
#include "verify/report.h"

#include <algorithm>
#include <cmath>

#include "plot/chart.h"
#include "scene/json_text.h"

namespace swallowclip::verify {
namespace {
constexpr std::size_t kMostCurves = 6;  // of one chart, evenly chosen; more cannot be told apart

std::string number(double x) {
  return std::isfinite(x) ? fmt::format("{:.4g}", x) : "-";
}
std::string shareOf(const CheckResult& c, double x) {
  if (!std::isfinite(x)) return "-";
  return c.absolute ? fmt::format("{:.2g}", x) : fmt::format("{:.3g} %", x * 100);
}

std::string jsonNumber(double x) {
  return std::isfinite(x) ? fmt::format("{:.9g}", x) : "null";
}

/// Points as [coordinate or time, measured, reference].
std::string curvesJson(const std::vector<Curve>& curves) {
  std::string out;
  for (const Curve& curve : curves) {
    out += fmt::format("{}{{\"time_s\": {}, \"points\": [", out.empty() ? "" : ", ",
                       jsonNumber(curve.time_s));
    for (std::size_t k = 0; k < curve.points.size(); ++k) {
      const ProfileSum::Point& p = curve.points[k];
      out += fmt::format("{}[{}, {}, {}]", k > 0 ? ", " : "", jsonNumber(p.along),
                         jsonNumber(p.measured), jsonNumber(p.reference));
    }
    out += "]}";
  }
  return out;
}

plot::Chart chartOf(const CaseResult& result, const CheckResult& check) {
  plot::Chart chart;
  chart.title = fmt::format("{}: {}", result.name, check.title);
  chart.xLabel = check.xLabel;
  chart.yLabel = fmt::format("{} ({})", check.title, check.unit);
  const std::size_t n = check.curves.size(), shown = std::min(n, kMostCurves);
  for (std::size_t k = 0; k < shown; ++k) {
    const Curve& curve = check.curves[shown == n ? k : k * (n - 1) / (shown - 1)];
    plot::Series line, marks;
    line.colour = marks.colour = static_cast<int>(k);
    marks.markers = true;
    for (const auto& p : curve.points) {
      line.points.emplace_back(p.along, p.reference);
      marks.points.emplace_back(p.along, p.measured);
    }
    line.label = k == 0 ? "reference" : "";
    marks.label =
        check.series || curve.time_s == 0 ? "measured" : fmt::format("t = {:.4g} s", curve.time_s);
    chart.series.push_back(std::move(line));
    chart.series.push_back(std::move(marks));
  }
  return chart;
}
}  // namespace

std::string tableHead() {
  return fmt::format("{:<28} {:<38} {:>11} {:>11} {:>6} {:>9} {:>9} {:>6} {:>8}\n", "case",
                     "quantity", "measured", "reference", "unit", "error", "allowed", "order",
                     "seconds");
}

std::string tableRows(const CaseResult& result) {
  std::string rows;
  if (!result.failure.empty())
    rows += fmt::format("{:<28} {}  FAIL\n", result.name, result.failure);
  bool first = true;
  for (const CheckResult& c : result.checks) {
    rows += fmt::format("{:<28} {:<38} {:>11} {:>11} {:>6} {:>9} {:>9} {:>6} {:>8}  {}\n",
                        first ? result.name : "", c.title, number(c.measured), number(c.reference),
                        c.unit, shareOf(c, c.error), shareOf(c, c.tolerance),
                        c.order ? fmt::format("{:.2f}", *c.order) : "",
                        first ? fmt::format("{:.1f}", result.seconds) : "",
                        c.pass && result.failure.empty() ? "pass" : "FAIL");
    first = false;
  }
  return rows;
}

std::string resultsJson(const std::vector<CaseResult>& results) {
  std::string out =
      fmt::format("{{\n  \"version\": {},\n  \"cases\": [", scene::quotedJson(SWALLOWCLIP_VERSION));
  bool firstCase = true;
  for (const CaseResult& r : results) {
    out += fmt::format(
        "{}\n    {{\"name\": {}, \"pass\": {}, \"solver\": {}, \"spacing_mm\": {}, "
        "\"particles\": {}, \"steps\": {}, \"escaped\": {}, \"clamped\": {}, "
        "\"mean_density_error\": {}, \"max_density_error\": {}, \"seconds\": {}, "
        "\"failure\": {},\n     \"checks\": [",
        firstCase ? "" : ",", scene::quotedJson(r.name), r.pass, scene::quotedJson(r.solver),
        jsonNumber(r.spacing_m * 1e3), r.particles, r.stats.steps, r.stats.escaped, r.stats.clamped,
        jsonNumber(r.stats.meanDensityError), jsonNumber(r.stats.maxDensityError),
        jsonNumber(r.seconds), r.failure.empty() ? "null" : scene::quotedJson(r.failure));
    firstCase = false;
    bool firstCheck = true;
    for (const CheckResult& c : r.checks) {
      out += fmt::format(
          "{}\n      {{\"quantity\": {}, \"unit\": {}, \"measured\": {}, \"reference\": {}, "
          "\"error\": {}, \"tolerance\": {}, \"absolute\": {}, \"order\": {}, \"pass\": {}, "
          "\"curves\": [{}]}}",
          firstCheck ? "" : ",", scene::quotedJson(c.title), scene::quotedJson(c.unit),
          jsonNumber(c.measured), jsonNumber(c.reference), jsonNumber(c.error),
          jsonNumber(c.tolerance), c.absolute, c.order ? jsonNumber(*c.order) : "null", c.pass,
          curvesJson(c.curves));
      firstCheck = false;
    }
    out += "]}";
  }
  out += "\n  ]\n}\n";
  return out;
}

Result<void> writeCharts(const CaseResult& result, const std::filesystem::path& folder) {
  int count = 0;
  for (const CheckResult& check : result.checks) {
    if (check.curves.empty()) continue;
    ++count;
    const std::string stem = count == 1 ? result.name : fmt::format("{}-{}", result.name, count);
    const plot::Chart chart = chartOf(result, check);
    if (auto ok = plot::writeSvg(chart, folder / fmt::format("{}.svg", stem)); !ok) return ok;
    if (auto ok = plot::writePng(chart, folder / fmt::format("{}.png", stem)); !ok) return ok;
  }
  return {};
}
}  // namespace swallowclip::verify
