// SPDX-License-Identifier: MIT
#include "core/error.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace swallowclip {

std::string Error::text() const {
  std::string s = place.empty() ? problem : place + ": " + problem;
  if (!remedy.empty()) s += "\n  " + remedy;
  return s;
}

std::string nearestName(std::string_view word, const std::vector<std::string>& known) {
  std::string best;
  size_t bestDistance = 2 + word.size() / 3;
  for (const std::string& k : known) {
    std::vector<size_t> row(k.size() + 1);
    for (size_t j = 0; j <= k.size(); ++j) row[j] = j;
    for (size_t i = 1; i <= word.size(); ++i) {
      size_t diagonal = row[0];
      row[0] = i;
      for (size_t j = 1; j <= k.size(); ++j) {
        const size_t up = row[j];
        row[j] = std::min({up + 1, row[j - 1] + 1, diagonal + (word[i - 1] != k[j - 1])});
        diagonal = up;
      }
    }
    if (row.back() < bestDistance) {
      bestDistance = row.back();
      best = k;
    }
  }
  return best;
}

void checkFailed(const char* file, int line, const char* expression, const std::string& values) {
  std::fprintf(stderr, "%s:%d: internal check failed: %s (%s)\n", file, line, expression,
               values.c_str());
  std::abort();
}
}  // namespace swallowclip
