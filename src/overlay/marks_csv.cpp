// SPDX-License-Identifier: MIT
#include "overlay/marks_csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace swallowclip::overlay {
namespace {
constexpr std::size_t kMaxRows = 100000;  // assumed, range 1e4 to 1e6

std::string place(std::size_t row) {
  return fmt::format("events file, row {}", row);
}
std::unexpected<Error> refuse(std::size_t row, const std::string& problem,
                              const std::string& remedy) {
  return usageError(place(row), problem, remedy);
}

std::string trimmed(const std::string& cell) {
  const std::size_t a = cell.find_first_not_of(" \t\r"), b = cell.find_last_not_of(" \t\r");
  return a == std::string::npos ? "" : cell.substr(a, b - a + 1);
}

/// Rows of cells; "" inside quotes is one quote (RFC 4180).
std::vector<std::vector<std::string>> cells(const std::string& text, char separator) {
  std::vector<std::vector<std::string>> rows(1, std::vector<std::string>(1));
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    std::string& cell = rows.back().back();
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      cell += text[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == separator) {
      rows.back().emplace_back();
    } else if (!quoted && c == '\n') {
      rows.emplace_back(1);
    } else {
      cell += c;
    }
  }
  return rows;
}

/// The one that the first row has most of.
char separatorOf(const std::string& text) {
  const std::string head = text.substr(0, text.find('\n'));
  char best = ',';
  for (const char c : {',', ';', '\t'})
    if (std::ranges::count(head, c) > std::ranges::count(head, best)) best = c;
  return best;
}

std::optional<double> number(std::string cell, char separator) {
  if (separator != ',') std::ranges::replace(cell, ',', '.');
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

struct Table {
  char separator = ',';
  int kind = -1, name = -1, frame = -1, x = -1, y = -1;

  Result<void> readHead(const std::vector<std::string>& head, std::size_t row) {
    for (std::size_t i = 0; i < head.size(); ++i) {
      std::string word = trimmed(head[i]);
      std::ranges::transform(word, word.begin(), [](unsigned char c) {
        return c == ' ' ? '_' : static_cast<char>(std::tolower(c));
      });
      const int at = static_cast<int>(i);
      if (word == "kind" || word == "type") kind = at;
      if (word == "name" || word == "event" || word == "landmark") name = at;
      if (word == "frame") frame = at;
      if (word == "x_px" || word == "x") x = at;
      if (word == "y_px" || word == "y") y = at;
    }
    if (kind < 0 || name < 0 || frame < 0)
      return refuse(row, "the first row must name the columns kind, name and frame",
                    "Write kind,name,frame,x_px,y_px above the table.");
    return {};
  }
  static std::string at(const std::vector<std::string>& row, int column) {
    return column >= 0 && column < static_cast<int>(row.size()) ? trimmed(row[column]) : "";
  }
};

Result<void> readRow(const Table& t, const std::vector<std::string>& cells, std::size_t row,
                     Marks& marks, std::vector<Vec2>& ends) {
  std::string kind = Table::at(cells, t.kind);
  std::ranges::transform(kind, kind.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::string frameCell = Table::at(cells, t.frame);
  const auto frame = number(frameCell, t.separator);
  const auto x = number(Table::at(cells, t.x), t.separator);
  const auto y = number(Table::at(cells, t.y), t.separator);
  if (!frameCell.empty() && (!frame || *frame != std::floor(*frame) || std::abs(*frame) > 1e6))
    return refuse(row, "the frame is no whole number", "Correct it.");
  if (kind == "event") {
    if (!frame) return refuse(row, "an event without a frame", "Add it, or remove the row.");
    auto name = knownName(Table::at(cells, t.name), eventNames(), "event", place(row));
    if (!name) return std::unexpected(name.error());
    marks.events.push_back({*name, static_cast<int>(*frame)});
    return {};
  }
  if (kind != "landmark" && kind != "calibration")
    return refuse(row, "an unknown kind", "Known: event, landmark, calibration.");
  if (!x || !y) return refuse(row, "a point without x_px and y_px", "Add them.");
  if (kind == "landmark") {
    auto name = knownName(Table::at(cells, t.name), landmarkNames(), "landmark", place(row));
    if (!name) return std::unexpected(name.error());
    MarkedPoint point{*name, std::nullopt, {*x, *y}};
    if (frame) point.frame = static_cast<int>(*frame);
    marks.points.push_back(point);
    return {};
  }
  const auto length_mm = number(Table::at(cells, t.name), t.separator);
  if (!length_mm || *length_mm < 1 || *length_mm > 500)
    return refuse(row, "the length of a calibration object is no number from 1 to 500 mm",
                  "Write it under name, in both rows.");
  ends.push_back({*x, *y});
  if (ends.size() > 2) return refuse(row, "a third end of the calibration object", "Keep two.");
  if (ends.size() == 2) marks.calibration = Calibration{ends[0], ends[1], *length_mm * kMetrePerMm};
  return {};
}
}  // namespace

Result<Marks> readCsv(const std::string& raw) {
  const std::string text = raw.starts_with("\xef\xbb\xbf") ? raw.substr(3) : raw;
  Table table;
  table.separator = separatorOf(text);
  const auto rows = cells(text, table.separator);
  if (rows.size() > kMaxRows)
    return refuse(kMaxRows, "too many rows", "Give the events of one study.");
  Marks marks;
  std::vector<Vec2> ends;
  bool headed = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (std::ranges::all_of(rows[i], [](const auto& c) { return trimmed(c).empty(); })) continue;
    if (!headed) {
      if (auto read = table.readHead(rows[i], i + 1); !read) return std::unexpected(read.error());
      headed = true;
      continue;
    }
    if (auto read = readRow(table, rows[i], i + 1, marks, ends); !read)
      return std::unexpected(read.error());
  }
  if (!headed)
    return refuse(1, "the first row must name the columns kind, name and frame",
                  "Write kind,name,frame,x_px,y_px above the table.");
  if (ends.size() == 1) return refuse(rows.size(), "one end of a calibration object", "Give both.");
  return marks;
}
}  // namespace swallowclip::overlay
