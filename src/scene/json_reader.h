// SPDX-License-Identifier: MIT
// JSON from outside, read strictly. Accessors never throw and never stop: the first problem
// (missing key, wrong type, out of range, duplicate, unknown key) is kept with its file:line:column
// and a harmless value is returned, so that a parser is one straight line ended by `finish()`.
//
//   auto file = JsonFile::load("scenes/boluses.json");  if (!file) return
//   std::unexpected(file.error()); const double density_kgm3 = file->root().number("density_kgm3",
//   500, 3000); if (auto done = file->finish(); !done) return std::unexpected(done.error());
//
// Keys "comment" and "source" (text) are allowed in every object and need not be read.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/vec.h"

namespace swallowclip::scene {

struct JsonDocument;  // tree with the position of every value; see json_reader.cpp

/// A cheap handle on one value; valid as long as the JsonFile or any other handle lives.
class JsonNode {
 public:
  /// False for the handle returned after something was missing; all its accessors are silent.
  bool exists() const { return index_ >= 0; }
  bool has(std::string_view key) const;

  double number(std::string_view key, double min, double max) const;
  double number(std::string_view key, double min, double max, double defaultValue) const;
  int integer(std::string_view key, int min, int max) const;
  int integer(std::string_view key, int min, int max, int defaultValue) const;
  std::string text(std::string_view key) const;
  std::string text(std::string_view key, std::string defaultValue) const;
  bool boolean(std::string_view key, bool defaultValue) const;
  /// One of `words`; an unknown one is answered with the nearest.
  std::string choice(std::string_view key, const std::vector<std::string>& words) const;
  std::string choice(std::string_view key, const std::vector<std::string>& words,
                     std::string defaultValue) const;
  Vec3 vec3(std::string_view key) const;
  Vec3 vec3(std::string_view key, const Vec3& defaultValue) const;
  std::vector<double> numbers(std::string_view key) const;
  std::vector<std::string> texts(std::string_view key) const;
  std::vector<Vec3> points3(std::string_view key) const;
  std::vector<Vec2> points2(std::string_view key) const;
  JsonNode object(std::string_view key) const;
  /// The value under a key, whatever its kind.
  JsonNode member(std::string_view key) const { return require(key); }
  /// The elements of a list (of objects, lists, numbers ...).
  std::vector<JsonNode> array(std::string_view key) const;
  /// All members in file order; reads them all, so none of them is "unknown" any more.
  std::vector<std::pair<std::string, JsonNode>> members() const;

  bool isObject() const;
  bool isArray() const;
  bool isNumber() const;
  bool isText() const;
  // This value itself, e.g. an element of array().
  double asNumber(double min, double max) const;
  std::string asText() const;
  std::vector<double> asNumbers() const;
  std::vector<JsonNode> asArray() const;

  /// Records a problem at this value (finish() tells the first).
  void fail(std::string problem, std::string remedy) const;
  /// "file:line:column"
  std::string place() const;

 private:
  friend class JsonFile;
  JsonNode(std::shared_ptr<JsonDocument> document, int index)
      : document_(std::move(document)), index_(index) {}
  int find(std::string_view key) const;
  JsonNode require(std::string_view key) const;
  JsonNode missing() const { return {document_, -1}; }
  bool wants(int kind, std::string_view what) const;
  template <int N>
  std::vector<Eigen::Matrix<double, N, 1>> points(std::string_view key) const;

  std::shared_ptr<JsonDocument> document_;
  int index_ = -1;
};

class JsonFile {
 public:
  /// Reads and checks the syntax: UTF-8, at most 64 MB, 64 levels and 1 million values.
  static Result<JsonFile> load(const std::filesystem::path& path);
  static Result<JsonFile> parse(std::string text, std::string name);

  JsonNode root() const;
  /// The first problem found, unknown keys included. To be asked once, at the end.
  Result<void> finish() const;
  /// Instead of finish(): all problems, in the order found.
  std::vector<Error> problems() const;

 private:
  explicit JsonFile(std::shared_ptr<JsonDocument> document) : document_(std::move(document)) {}
  std::shared_ptr<JsonDocument> document_;
};
}  // namespace swallowclip::scene
