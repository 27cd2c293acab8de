// SPDX-License-Identifier: MIT
#include "scene/json_document.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_set>

namespace swallowclip::scene {
namespace {
constexpr std::size_t kMaxBytes = 64u << 20;   // 64 MB: our largest scene file is below 1 MB
constexpr std::size_t kMaxValues = 1'000'000;  // ours have below 5000; about 250 MB at worst
constexpr std::size_t kMaxDepth = 64;          // levels; ours need 6
constexpr std::size_t kExcerpt = 100;          // columns shown of the offending line
constexpr std::size_t kMostErrors = 50;        // more than anybody reads at once

/// Receives the library's events in file order and finds each token's position by walking the text
/// beside it: between two tokens stand only white space, ',' and ':'.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit TreeBuilder(JsonDocument& document) : doc_(document) {}

  bool null() override { return add(JsonValue::null); }
  bool boolean(bool value) override {
    if (!add(JsonValue::boolean)) return false;
    doc_.values.back().flag = value;
    return true;
  }
  bool number_integer(number_integer_t value) override { return addNumber(double(value)); }
  bool number_unsigned(number_unsigned_t value) override { return addNumber(double(value)); }
  bool number_float(number_float_t value, const string_t&) override { return addNumber(value); }
  bool string(string_t& value) override {
    if (!add(JsonValue::text)) return false;
    doc_.values.back().word = addWord(std::move(value));
    return true;
  }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(JsonValue::object); }
  bool start_array(std::size_t) override { return open(JsonValue::array); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& value) override {
    keyOffset_ = takeToken();
    if (!keys_.back().insert(value).second) {
      doc_.fail(keyOffset_, fmt::format("the key \"{}\" appears twice", printable(value)),
                "Remove one of the two.");
      return false;
    }
    keyWord_ = addWord(std::move(value));
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    const std::size_t at = std::min(position == 0 ? 0 : position - 1, doc_.text.size());
    const bool tooBig = error.id == 406;  // nlohmann's out_of_range: number overflow
    doc_.fail(at,
              tooBig ? "a number too large for a 64-bit float" : syntaxProblem(at, error.what()),
              "Correct the JSON at this place.");
    return false;
  }

 private:
  std::string syntaxProblem(std::size_t at, std::string what) const {
    if (at >= doc_.text.size()) return "the file ends in the middle of the JSON";
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while ..."
    const std::size_t start = what.find(": ");
    if (start != std::string::npos) what = what.substr(start + 2);
    if (what.find("ill-formed UTF-8") != std::string::npos) return "the text is not valid UTF-8";
    if (const std::size_t last = what.find("; last read"); last != std::string::npos) {
      const std::size_t expected = what.find("; expected", last);
      what = what.substr(0, last) + (expected == std::string::npos ? "" : what.substr(expected));
    }
    return "not valid JSON: " + printable(what);
  }

  /// Start of the next token; moves the cursor past it.
  std::size_t takeToken() {
    const std::string& t = doc_.text;
    while (cursor_ < t.size() && std::string_view(" \t\r\n,:").contains(t[cursor_])) ++cursor_;
    const std::size_t start = cursor_;
    if (start >= t.size()) return start;
    if (t[start] == '"') {
      for (++cursor_; cursor_ < t.size() && t[cursor_] != '"'; ++cursor_)
        if (t[cursor_] == '\\') ++cursor_;
      ++cursor_;
    } else if (std::string_view("{}[]").contains(t[start])) {
      ++cursor_;
    } else {
      while (cursor_ < t.size() && !std::string_view(" \t\r\n,:{}[]\"").contains(t[cursor_]))
        ++cursor_;
    }
    return start;
  }

  int addWord(std::string word) {
    doc_.words.push_back(std::move(word));
    return static_cast<int>(doc_.words.size()) - 1;
  }

  bool add(JsonValue::Kind kind) {
    JsonValue value;
    value.kind = kind;
    value.offset = static_cast<std::uint32_t>(takeToken());
    if (doc_.values.size() >= kMaxValues) {
      doc_.fail(value.offset, fmt::format("more than {} values", kMaxValues),
                "Split the file; a scene needs far less.");
      return false;
    }
    const int index = static_cast<int>(doc_.values.size());
    if (!stack_.empty()) {
      JsonValue& parent = doc_.values[stack_.back()];
      if (parent.kind == JsonValue::object) {
        value.keyOffset = static_cast<std::uint32_t>(keyOffset_);
        value.keyWord = keyWord_;
      }
      (parent.lastChild < 0 ? parent.firstChild : doc_.values[parent.lastChild].next) = index;
      parent.lastChild = index;
      ++parent.count;
    }
    doc_.values.push_back(value);
    return true;
  }

  bool addNumber(double value) {
    if (!add(JsonValue::number)) return false;
    doc_.values.back().number_ = value;
    if (std::isfinite(value)) return true;
    doc_.fail(doc_.values.back().offset, "a number too large for a 64-bit float", "Correct it.");
    return false;
  }

  bool open(JsonValue::Kind kind) {
    if (!add(kind)) return false;
    stack_.push_back(static_cast<int>(doc_.values.size()) - 1);
    keys_.emplace_back();
    if (stack_.size() <= kMaxDepth) return true;
    doc_.fail(doc_.values.back().offset, fmt::format("nested deeper than {} levels", kMaxDepth),
              "Flatten the file; a scene needs far fewer.");
    return false;
  }

  bool close() {
    takeToken();
    stack_.pop_back();
    keys_.pop_back();
    return true;
  }

  JsonDocument& doc_;
  std::size_t cursor_ = 0, keyOffset_ = 0;
  int keyWord_ = -1;
  std::vector<int> stack_;
  std::vector<std::unordered_set<std::string>> keys_;
};
}  // namespace

std::string printable(std::string_view word) {
  constexpr std::size_t kLongest = 160;
  std::size_t end = std::min(word.size(), kLongest);
  while (end < word.size() && end > 0 && (word[end] & 0xC0) == 0x80) --end;  // whole UTF-8 letters
  std::string shown(word.substr(0, end));
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return end < word.size() ? shown + "..." : shown;
}

std::string JsonDocument::place(std::size_t offset) const {
  offset = std::min(offset, text.size());
  const std::string_view before(text.data(), offset);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t lineStart = before.rfind('\n') + 1;  // npos + 1 == 0
  return fmt::format("{}:{}:{}", name, line, offset - lineStart + 1);
}

std::string JsonDocument::excerpt(std::size_t offset) const {
  offset = std::min(offset, text.size());
  const std::size_t lineStart = std::string_view(text.data(), offset).rfind('\n') + 1;
  const std::size_t newline = text.find('\n', offset);
  const std::size_t lineEnd = newline == std::string::npos ? text.size() : newline;
  std::size_t from = offset - lineStart > kExcerpt / 2 ? offset - kExcerpt / 2 : lineStart;
  while (from < offset && (text[from] & 0xC0) == 0x80) ++from;
  std::string line = text.substr(from, std::min(lineEnd - from, kExcerpt));
  std::size_t letters = 0;
  for (std::size_t i = 0; i < offset - from; ++i) letters += (text[from + i] & 0xC0) != 0x80;
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  return "\n    " + line + "\n    " + std::string(letters, ' ') + "^";
}

void JsonDocument::fail(std::size_t offset, std::string problem, std::string remedy) {
  if (errors.size() < kMostErrors)
    errors.push_back(
        {ErrorKind::usage, place(offset), std::move(problem) + excerpt(offset), std::move(remedy)});
}

Result<std::shared_ptr<JsonDocument>> parseJson(std::string text, std::string name) {
  if (text.size() > kMaxBytes)
    return usageError(
        name, fmt::format("{} MB, at most {} MB are read", text.size() >> 20, kMaxBytes >> 20),
        "Check that this is the file you meant.");
  if (text.starts_with("\xEF\xBB\xBF")) text.replace(0, 3, "   ");  // byte order mark
  auto document = std::make_shared<JsonDocument>();
  document->name = std::move(name);
  document->text = std::move(text);
  TreeBuilder builder(*document);
  const bool whole = nlohmann::json::sax_parse(document->text, &builder);
  if (!document->errors.empty()) return std::unexpected(document->errors.front());
  if (!whole || document->values.empty())
    return usageError(document->name, "not valid JSON", "Check that this is the file you meant.");
  return document;
}
}  // namespace swallowclip::scene
