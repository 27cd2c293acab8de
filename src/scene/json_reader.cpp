// SPDX-License-Identifier: MIT
#include "scene/json_reader.h"

#include <cmath>

#include "core/file.h"
#include "scene/json_document.h"

namespace swallowclip::scene {
namespace {
constexpr std::uintmax_t kMaxFileBytes = 64u << 20;  // as in json_document.cpp

std::string_view kindName(int kind) {
  switch (kind) {
    case JsonValue::boolean:
      return "true or false";
    case JsonValue::number:
      return "a number";
    case JsonValue::text:
      return "a text";
    case JsonValue::array:
      return "a list";
    case JsonValue::object:
      return "an object";
    default:
      return "null";
  }
}

/// `"key": ` in front of a message about a member's value.
std::string keyPrefix(const JsonDocument& doc, const JsonValue& value) {
  return value.keyWord < 0 ? "" : fmt::format("\"{}\": ", printable(doc.words[value.keyWord]));
}

std::string wordList(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// An unread member is an unknown key; nested ones are looked at when their parent was read. What
/// is merely unused counts only in a file without other problems: they may have kept it from being
/// read.
void findUnknownKeys(JsonDocument& doc) {
  static const std::vector<std::string> kAlwaysAllowed{"comment", "source"};
  const bool good = doc.errors.empty();
  for (std::size_t i = 0; i < doc.values.size(); ++i) {
    const auto asked = doc.asked.find(static_cast<int>(i));
    if (doc.values[i].kind != JsonValue::object || asked == doc.asked.end()) continue;
    for (int c = doc.values[i].firstChild; c >= 0; c = doc.values[c].next) {
      const JsonValue& member = doc.values[c];
      const std::string& key = doc.words[member.keyWord];
      if (member.read || key == kAlwaysAllowed[0] || key == kAlwaysAllowed[1]) continue;
      const std::vector<std::string> known(asked->second.begin(), asked->second.end());
      const bool unused = asked->second.contains(key);
      if (unused && !good) continue;
      const std::string near = nearestName(key, known);
      doc.fail(member.keyOffset,
               fmt::format("{} key \"{}\"", unused ? "unused" : "unknown", printable(key)),
               unused         ? "Remove it: nothing reads it here."
               : near.empty() ? "Known here: " + wordList(known) + "."
                              : "Did you mean \"" + near + "\"?");
    }
  }
}
}  // namespace

Result<JsonFile> JsonFile::load(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    return usageError(path.string(), "no such file", "Check the name and the folder.");
  if (!std::filesystem::is_regular_file(status))
    return usageError(path.string(), "not a regular file", "Give the name of a JSON file.");
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (!error && bytes > kMaxFileBytes)
    return usageError(
        path.string(),
        fmt::format("{} MB, at most {} MB are read", bytes >> 20, kMaxFileBytes >> 20),
        "Check that this is the file you meant.");
  auto text = readFile(path);
  if (!text) return std::unexpected(text.error());
  return parse(std::move(*text), path.string());
}

Result<JsonFile> JsonFile::parse(std::string text, std::string name) {
  auto document = parseJson(std::move(text), std::move(name));
  if (!document) return std::unexpected(document.error());
  return JsonFile(std::move(*document));
}

JsonNode JsonFile::root() const {
  return {document_, 0};
}

Result<void> JsonFile::finish() const {
  const std::vector<Error> all = problems();
  if (!all.empty()) return std::unexpected(all.front());
  return {};
}

std::vector<Error> JsonFile::problems() const {
  const std::vector<Error> read = document_->errors;
  findUnknownKeys(*document_);
  return std::exchange(document_->errors, read);
}

std::string JsonNode::place() const {
  return exists() ? document_->place(document_->values[index_].offset) : document_->name;
}

void JsonNode::fail(std::string problem, std::string remedy) const {
  document_->fail(exists() ? document_->values[index_].offset : 0, std::move(problem),
                  std::move(remedy));
}

/// Right kind? Otherwise records what stands there instead.
bool JsonNode::wants(int kind, std::string_view what) const {
  if (!exists()) return false;
  const JsonValue& value = document_->values[index_];
  if (value.kind == kind) return true;
  const std::string key = keyPrefix(*document_, value);
  fail(fmt::format("{}expected {}, found {}", key, what, kindName(value.kind)),
       "Correct the value.");
  return false;
}

/// Index of the member, marked as read, or -1.
int JsonNode::find(std::string_view key) const {
  if (!wants(JsonValue::object, "an object")) return -1;
  document_->asked[index_].emplace(key);
  for (int c = document_->values[index_].firstChild; c >= 0; c = document_->values[c].next)
    if (document_->words[document_->values[c].keyWord] == key) return c;
  return -1;
}

bool JsonNode::has(std::string_view key) const {
  return find(key) >= 0;
}

JsonNode JsonNode::require(std::string_view key) const {
  const int c = find(key);
  if (c >= 0) {
    document_->values[c].read = true;
    return {document_, c};
  }
  if (exists()) {
    // A misspelt key is the likeliest reason for a missing one, so point at it.
    std::vector<std::string> present;
    for (int m = document_->values[index_].firstChild; m >= 0; m = document_->values[m].next)
      if (!document_->values[m].read)
        present.push_back(document_->words[document_->values[m].keyWord]);
    const std::string near = nearestName(key, present);
    fail(fmt::format("the key \"{}\" is missing", key),
         near.empty() ? "Add it to this object."
                      : fmt::format("Did you mean it by \"{}\"?", printable(near)));
  }
  return missing();
}

double JsonNode::asNumber(double min, double max) const {
  if (!wants(JsonValue::number, "a number")) return min <= 0 && max >= 0 ? 0 : min;
  const JsonValue& value = document_->values[index_];
  if (value.number_ >= min && value.number_ <= max) return value.number_;
  const std::string key = keyPrefix(*document_, value);
  fail(fmt::format("{}{} is outside {} to {}", key, value.number_, min, max),
       "Check value and unit.");
  return min;
}

std::string JsonNode::asText() const {
  if (!wants(JsonValue::text, "a text")) return "";
  const std::string& word = document_->words[document_->values[index_].word];
  if (word.find('\0') == std::string::npos) return word;
  fail("the text holds a zero character", "Remove it.");
  return "";
}

std::vector<JsonNode> JsonNode::asArray() const {
  std::vector<JsonNode> nodes;
  if (!wants(JsonValue::array, "a list")) return nodes;
  nodes.reserve(document_->values[index_].count);
  for (int c = document_->values[index_].firstChild; c >= 0; c = document_->values[c].next)
    nodes.push_back({document_, c});
  return nodes;
}

std::vector<double> JsonNode::asNumbers() const {
  std::vector<double> values;
  for (const JsonNode& node : asArray()) values.push_back(node.asNumber(-1e300, 1e300));
  return values;
}

double JsonNode::number(std::string_view key, double min, double max) const {
  return require(key).asNumber(min, max);
}
double JsonNode::number(std::string_view key, double min, double max, double defaultValue) const {
  return has(key) ? number(key, min, max) : defaultValue;
}

int JsonNode::integer(std::string_view key, int min, int max) const {
  const JsonNode node = require(key);
  const double value = node.asNumber(min, max);
  if (value == std::floor(value)) return static_cast<int>(value);
  node.fail(fmt::format("\"{}\": {} is not a whole number", key, value), "Give a whole number.");
  return min;
}
int JsonNode::integer(std::string_view key, int min, int max, int defaultValue) const {
  return has(key) ? integer(key, min, max) : defaultValue;
}

std::string JsonNode::text(std::string_view key) const {
  return require(key).asText();
}
std::string JsonNode::text(std::string_view key, std::string defaultValue) const {
  return has(key) ? text(key) : defaultValue;
}

bool JsonNode::boolean(std::string_view key, bool defaultValue) const {
  if (!has(key)) return defaultValue;
  const JsonNode node = require(key);
  return node.wants(JsonValue::boolean, "true or false") ? document_->values[node.index_].flag
                                                         : defaultValue;
}

std::string JsonNode::choice(std::string_view key, const std::vector<std::string>& words) const {
  const JsonNode node = require(key);
  const bool isText = node.wants(JsonValue::text, "one of " + wordList(words));
  const std::string harmless = words.empty() ? "" : words.front();
  if (!isText) return harmless;
  const std::string word = node.asText();
  for (const std::string& known : words)
    if (word == known) return word;
  const std::string near = nearestName(word, words);
  node.fail(
      fmt::format("\"{}\": unknown word \"{}\"; known: {}", key, printable(word), wordList(words)),
      near.empty() ? "Choose one of these." : "Did you mean \"" + near + "\"?");
  return harmless;
}
std::string JsonNode::choice(std::string_view key, const std::vector<std::string>& words,
                             std::string defaultValue) const {
  return has(key) ? choice(key, words) : defaultValue;
}

Vec3 JsonNode::vec3(std::string_view key) const {
  const JsonNode node = require(key);
  const std::vector<double> v = node.asNumbers();
  if (v.size() == 3) return {v[0], v[1], v[2]};
  if (node.isArray())
    node.fail(fmt::format("\"{}\": {} numbers, expected 3", key, v.size()), "Give [x, y, z].");
  return Vec3::Zero();
}
Vec3 JsonNode::vec3(std::string_view key, const Vec3& defaultValue) const {
  return has(key) ? vec3(key) : defaultValue;
}

std::vector<double> JsonNode::numbers(std::string_view key) const {
  return require(key).asNumbers();
}

std::vector<std::string> JsonNode::texts(std::string_view key) const {
  std::vector<std::string> words;
  for (const JsonNode& node : require(key).asArray()) words.push_back(node.asText());
  return words;
}

template <int N>
std::vector<Eigen::Matrix<double, N, 1>> JsonNode::points(std::string_view key) const {
  std::vector<Eigen::Matrix<double, N, 1>> out;
  for (const JsonNode& node : require(key).asArray()) {
    const std::vector<double> v = node.asNumbers();
    if (v.size() != N) {
      if (node.isArray())
        node.fail(fmt::format("\"{}\": a point of {} numbers, expected {}", key, v.size(), N),
                  "Correct the point.");
      return {};
    }
    out.push_back(Eigen::Map<const Eigen::Matrix<double, N, 1>>(v.data()));
  }
  return out;
}
std::vector<Vec3> JsonNode::points3(std::string_view key) const {
  return points<3>(key);
}
std::vector<Vec2> JsonNode::points2(std::string_view key) const {
  return points<2>(key);
}

JsonNode JsonNode::object(std::string_view key) const {
  const JsonNode node = require(key);
  if (!node.wants(JsonValue::object, "an object")) return missing();
  document_->asked[node.index_];  // read now: its unknown keys count
  return node;
}

std::vector<JsonNode> JsonNode::array(std::string_view key) const {
  return require(key).asArray();
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
  std::vector<std::pair<std::string, JsonNode>> out;
  if (!wants(JsonValue::object, "an object")) return out;
  for (int c = document_->values[index_].firstChild; c >= 0; c = document_->values[c].next) {
    document_->values[c].read = true;
    const std::string& key = document_->words[document_->values[c].keyWord];
    if (key != "comment" && key != "source") out.emplace_back(key, JsonNode(document_, c));
  }
  return out;
}

bool JsonNode::isObject() const {
  return exists() && document_->values[index_].kind == JsonValue::object;
}
bool JsonNode::isArray() const {
  return exists() && document_->values[index_].kind == JsonValue::array;
}
bool JsonNode::isNumber() const {
  return exists() && document_->values[index_].kind == JsonValue::number;
}
bool JsonNode::isText() const {
  return exists() && document_->values[index_].kind == JsonValue::text;
}
}  // namespace swallowclip::scene
