// SPDX-License-Identifier: MIT
// The tree behind json_reader.h: every value with its byte offset, and the problems found.
#pragma once
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/error.h"

namespace swallowclip::scene {

struct JsonValue {
  enum Kind : std::uint8_t { null, boolean, number, text, array, object };
  Kind kind = null;
  bool read = false;            ///< members only: some accessor asked for it
  bool flag = false;            ///< boolean
  std::uint32_t offset = 0;     ///< byte where the value starts
  std::uint32_t keyOffset = 0;  ///< byte where the member's key starts (members of objects)
  int firstChild = -1, lastChild = -1, next = -1, count = 0;
  int word = -1;     ///< text: index into words
  int keyWord = -1;  ///< member: its key, index into words
  double number_ = 0;
};

struct JsonDocument {
  std::string name, text;
  std::vector<JsonValue> values;  ///< values[0] is the root
  std::vector<std::string> words;
  /// Keys that were asked for, per object: what to suggest for an unknown key.
  std::unordered_map<int, std::set<std::string>> asked;
  std::vector<Error> errors;  ///< in the order found; at most kMostErrors
  std::string place(std::size_t offset) const;
  /// Keeps the problem, with the offending line and a caret.
  void fail(std::size_t offset, std::string problem, std::string remedy);
  std::string excerpt(std::size_t offset) const;
};

/// A key or word from the file, safe to print: shortened, control characters replaced.
std::string printable(std::string_view word);

Result<std::shared_ptr<JsonDocument>> parseJson(std::string text, std::string name);
}  // namespace swallowclip::scene
