// SPDX-License-Identifier: MIT
// Words of a command line into values.
#pragma once
#include <algorithm>
#include <charconv>
#include <string>
#include <vector>

#include "core/error.h"

namespace swallowclip::cli {
using Words = std::vector<std::string>;

inline Result<double> number(const char* place, const std::string& word, double min, double max) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = error == std::errc{} && end == word.data() + word.size();
  if (whole && value >= min && value <= max) return value;
  return usageError(place, fmt::format("\"{}\" is not a number from {} to {}", word, min, max),
                    "Correct the value.");
}

inline Result<int> integer(const char* place, const std::string& word, int min, int max) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc{} && end == word.data() + word.size() && value >= min && value <= max)
    return value;
  return usageError(place,
                    fmt::format("\"{}\" is not a whole number from {} to {}", word, min, max),
                    "Correct the value.");
}

inline Result<std::string> oneOf(const char* place, const std::string& word, const Words& known) {
  if (std::ranges::find(known, word) != known.end()) return word;
  const std::string near = nearestName(word, known);
  return usageError(place, fmt::format("unknown word \"{}\"", word),
                    near.empty() ? fmt::format("Known: {}.", fmt::join(known, ", "))
                                 : fmt::format("Did you mean \"{}\"?", near));
}

/// Stores a successful result, passes on the error of another.
template <class T, class U>
Result<void> store(Result<T> result, U& into) {
  if (!result) return std::unexpected(result.error());
  into = static_cast<U>(std::move(*result));
  return {};
}

inline Words splitAt(const std::string& text, char separator) {
  Words parts;
  std::size_t start = 0;
  for (std::size_t at; (at = text.find(separator, start)) != std::string::npos; start = at + 1)
    parts.push_back(text.substr(start, at - start));
  parts.push_back(text.substr(start));
  return parts;
}
}  // namespace swallowclip::cli
