// SPDX-License-Identifier: MIT
#include "library/report.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "core/file.h"
#include "plot/chart.h"

namespace swallowclip::library {
namespace fs = std::filesystem;
namespace {
constexpr std::size_t kLogTail = 4000;  // bytes of a failed job's log: its last screen
constexpr std::size_t kMostTrend = 60;  // nights in the charts: two months

std::string html(std::string_view text) {
  static const std::map<char, std::string> kNames{
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string out;
  for (const char c : text) {
    const auto at = kNames.find(c);
    out += at == kNames.end() ? std::string(1, c) : at->second;
  }
  return out;
}

std::string logTail(const fs::path& file) {
  std::error_code ec;
  const std::string log = fs::exists(file, ec) ? readFile(file).value_or("") : "";
  if (log.empty()) return "It left no word: it was killed, crashed, or was never started.";
  return log.size() > kLogTail ? "..." + log.substr(log.size() - kLogTail) : log;
}

/// Choices of one filter, in the order of the clips.
std::string select(const char* name, const char* label, const std::vector<std::string>& values) {
  std::string options = "<option value=\"\">all</option>";
  std::set<std::string> seen;
  for (const std::string& v : values)
    if (seen.insert(v).second)
      options += fmt::format("<option value=\"{0}\">{0}</option>", html(v));
  return fmt::format("<label>{}<select name=\"{}\">{}</select></label>\n", label, name, options);
}

class Page {
 public:
  Page(const Report& report, const Root& root) : r_(report), root_(root) {
    for (const Change& c : r_.changes) changes_[c.clip] = &c;
    for (const MissingClip& m : r_.gathered.missing) missing_[m.name] = &m;
  }

  std::string text(const std::string& css, const std::string& js) const {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width\">\n"
        "<link rel=\"icon\" href=\"data:,\">\n<title>Library, {}</title>\n<style>\n{}</style>"
        "</head>\n<body>\n{}{}{}{}{}{}{}\n<footer>Training illustrations, not for diagnosis. "
        "MBSImP "
        "is a trademark of its owner, named only to say what a clip is meant to show.</footer>\n"
        "<script>\n{}</script>\n</body></html>\n",
        html(r_.summary.when), css, head(), failures(), differences(), clips(), stages(), reasons(),
        trends(), js);
  }

 private:
  std::string head() const {
    const Summary& s = r_.summary;
    const char* verdict = s.outcome == Outcome::published ? "A new night was published."
                          : s.outcome == Outcome::unchanged
                              ? "Nothing has changed."
                              : "Not published: the last night stays.";
    const auto efficiency = s.efficiency();
    return fmt::format(
        "<h1>Clip library, night of {} UTC</h1>\n<div class=\"verdict{}\"><strong>{}</strong> {}"
        "<br>Shown: {} with {} clips{}. {} of {} jobs were run, {} failed, {} of {} clips missing."
        "<br>{:.0f} s{}, {:.0f} s of processor time{}.</div>\n",
        html(s.when), s.outcome == Outcome::kept ? "" : " good", verdict, html(s.problem),
        s.night.empty() ? "nothing" : html(s.night), s.clips,
        r_.shown && r_.shown->draft ? " (a draft: labels were not asked for)" : "", s.run, s.jobs,
        s.failed, s.missing, r_.plan.clips.size(), s.wall_s,
        s.processors > 0 ? fmt::format(" on {} processors", s.processors) : "", s.cpuSum_s(),
        efficiency ? fmt::format(", {:.0f} % of what they had", 100 * *efficiency) : "");
  }

  std::string failures() const {
    std::string text;
    for (const PlannedJob& p : r_.plan.jobs) {
      const bool waited =
          std::ranges::any_of(p.needs, [&](int k) { return r_.plan.jobs[k].stale(); });
      if (!p.stale() || waited) continue;
      text += fmt::format(
          "<details open><summary>{}</summary><p>Replay: <code>swallowclip job {} --out '{}'</code>"
          "</p><pre tabindex=\"0\">{}</pre></details>\n",
          html(p.job.name), p.job.key, html(root_.path.string()),
          html(logTail(root_.log(p.job.key))));
    }
    for (const MissingClip& m : r_.gathered.missing)
      if (m.job.empty()) text += fmt::format("<p>{}: {}</p>\n", html(m.name), html(m.why));
    return text.empty() ? "" : "<h2>Failures</h2>\n" + text;
  }

  std::string differences() const {
    if (r_.changes.empty()) return "";
    std::string rows;
    std::set<std::string> told;  // views of one swallow have their measures in common
    for (const Change& c : r_.changes) {
      const std::string moved = fmt::format("{}", fmt::join(c.moved, "; "));
      const bool again = !moved.empty() && !told.insert(moved).second;
      rows += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n", html(c.clip),
                          c.isNew ? "new" : fmt::format("{:.4f}", c.difference),
                          again ? "as above, in another view" : html(moved));
    }
    return "<h2>Changed since the last night</h2>\n<table><tr><th>clip</th>"
           "<th>visible difference (0 none, 1 all)</th><th>measured values that moved</th></tr>\n" +
           rows + "</table>\n";
  }

  std::string clips() const {
    std::vector<std::string> components, scores, boluses, views, presets;
    std::string items;
    for (const PlannedClip& c : r_.plan.clips) {
      const Choice& shows = choice(c);
      components.push_back(fmt::format("{}", shows.component));
      scores.push_back(fmt::format("{}", shows.score));
      boluses.push_back(shows.bolus);
      views.push_back(shows.view);
      presets.push_back(shows.preset);
      items += item(c);
    }
    return "<h2>Clips</h2>\n<form class=\"filters\" onsubmit=\"return false\">\n"
           "<label>words ( / )<input name=\"words\" type=\"search\" "
           "autocomplete=\"off\"></label>\n" +
           select("state", "state", {"ok", "changed", "new", "missing"}) +
           select("component", "component", components) + select("score", "score", scores) +
           select("bolus", "bolus", boluses) + select("view", "view", views) +
           select("preset", "preset", presets) +
           "<output id=\"count\" aria-live=\"polite\"></output></form>\n<ul class=\"clips\">\n" +
           items + "</ul>\n";
  }

  const Choice& choice(const PlannedClip& c) const { return r_.plan.jobs[c.jobs[4]].job.choice; }

  std::string item(const PlannedClip& c) const {
    const Choice& is = choice(c);
    const NightClip* shown = r_.shown ? r_.shown->find(c.name) : nullptr;
    const auto change = changes_.find(c.name);
    const auto missing = missing_.find(c.name);
    const std::string state = missing != missing_.end()  ? "missing"
                              : change == changes_.end() ? "ok"
                              : change->second->isNew    ? "new"
                                                         : "changed";
    std::string picture = "<div class=\"none\">no picture</div>", links;
    if (shown) {
      const std::string night = "../nights/" + r_.shown->name + "/";
      const auto link = [&](const std::string& kind) {
        return html(night + nightPath(*shown, kind));
      };
      picture = fmt::format(
          "<a href=\"{}\"><img loading=\"lazy\" src=\"{}\" alt=\"Component {}, "
          "score {}, {} bolus, {} view\"></a>",
          link(".mp4"), link("thumb"), is.component, is.score, html(is.bolus), html(is.view));
      links = fmt::format("<p><a href=\"{}\">sheet</a> <a href=\"{}\">measures</a></p>",
                          link("sheet"), link(".json"));
    }
    std::string why = missing != missing_.end() ? missing->second->why : "";
    if (const NightClip* now = r_.gathered.find(c.name))
      why = (now->measured.labelConfirmed ? "label confirmed"
                                          : "label NOT confirmed: " + now->measured.labelReason);
    return fmt::format(
        "<li data-state=\"{0}\" data-component=\"{1}\" data-score=\"{2}\" data-bolus=\"{3}\" "
        "data-view=\"{4}\" data-preset=\"{5}\" data-words=\"{6} {0}\">{7}<p class=\"name\">{6}</p>"
        "<p><span class=\"tag {0}\">{0}</span> {8}</p>{9}</li>\n",
        state, is.component, is.score, html(is.bolus), html(is.view), html(is.preset), html(c.name),
        picture, html(why), links);
  }

  std::string stages() const {
    std::string rows;
    for (const Stage stage : kStages) {
      int all = 0, run = 0;
      double sum_s = 0, most_s = 0;
      for (const PlannedJob& p : r_.plan.jobs) {
        if (p.job.stage != stage) continue;
        ++all;
        if (!p.marker || !r_.tonight.has(p.job.key)) continue;
        ++run;
        sum_s += p.marker->cpu_s;
        most_s = std::max(most_s, p.marker->cpu_s);
      }
      rows += fmt::format(
          "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{:.1f}</td>"
          "<td class=\"n\">{:.1f}</td><td class=\"n\">{:.1f}</td></tr>\n",
          name(stage), all, run, sum_s, run > 0 ? sum_s / run : 0, most_s);
    }
    return "<h2>Stages</h2>\n<table><tr><th>stage</th><th>jobs</th><th>made tonight</th>"
           "<th>processor time (s)</th><th>mean (s)</th><th>longest (s)</th></tr>\n" +
           rows + "</table>\n";
  }

  std::string reasons() const {
    if (r_.tonight.jobs.empty()) return "";
    std::string rows;
    for (const auto& [key, why] : r_.tonight.jobs) rows += fmt::format("<li>{}</li>\n", html(why));
    return fmt::format(
        "<h2>What was stale, and why</h2>\n<details><summary>{} jobs</summary><ul>\n"
        "{}</ul></details>\n",
        r_.tonight.jobs.size(), rows);
  }

  static std::string trends() {
    return "<h2>Trends</h2>\n<div class=\"charts\"><img src=\"time.svg\" alt=\"Minutes per night\">"
           "<img src=\"clips.svg\" alt=\"Clips per night\"></div>\n";
  }

  const Report& r_;
  const Root& root_;
  std::map<std::string, const Change*> changes_;
  std::map<std::string, const MissingClip*> missing_;
};

Result<void> writeCharts(const Root& root) {
  std::vector<Summary> nights = loadNights(root);
  if (nights.size() > kMostTrend) nights.erase(nights.begin(), nights.end() - kMostTrend);
  plot::Chart time{"Time per night", "night (0 is the last)", "minutes", {}, 620, 360};
  plot::Chart clips{"Clips per night", "night (0 is the last)", "clips", {}, 620, 360};
  plot::Series wall{"elapsed", {}}, shown{"shown", {}}, missing{"missing", {}};
  std::map<std::string, plot::Series> stages;
  for (const Stage s : kStages) stages[name(s)].label = std::string(name(s)) + ", processor";
  for (std::size_t k = 0; k < nights.size(); ++k) {
    const double x = static_cast<double>(k) - static_cast<double>(nights.size() - 1);
    wall.points.emplace_back(x, nights[k].wall_s / 60);
    shown.points.emplace_back(x, nights[k].clips);
    missing.points.emplace_back(x, nights[k].missing);
    for (auto& [stage, series] : stages)
      series.points.emplace_back(
          x, nights[k].cpu_s.contains(stage) ? nights[k].cpu_s.at(stage) / 60 : 0);
  }
  time.series.push_back(wall);
  for (const char* stage : {"simulate", "draw"}) time.series.push_back(stages[stage]);
  clips.series = {shown, missing};
  if (auto done = plot::writeSvg(time, root.report() / "time.svg"); !done) return done;
  return plot::writeSvg(clips, root.report() / "clips.svg");
}
}  // namespace

Result<void> writeReport(const Report& report, const Root& root) {
  if (report.plan.jobs.empty()) return {};
  const fs::path assets = report.plan.jobs.front().job.choice.data / "report";
  auto css = readFile(assets / "nightly.css");
  if (!css) return std::unexpected(css.error());
  auto js = readFile(assets / "nightly.js");
  if (!js) return std::unexpected(js.error());
  if (auto done = writeCharts(root); !done) return done;
  return writeFile(root.report() / "index.html", Page(report, root).text(*css, *js));
}
}  // namespace swallowclip::library
