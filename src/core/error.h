// SPDX-License-Identifier: MIT
// What can fail from outside (files, GL, libav) returns Result<T>; bugs stop at a CHECK that
// prints both values. Only the cli room ends the process.
#pragma once
#include <fmt/format.h>

#include <expected>
#include <string>
#include <string_view>
#include <vector>

namespace swallowclip {

enum class ErrorKind {
  usage,   ///< the caller's words or input files are wrong (exit code 2)
  failed,  ///< the work itself could not be done (exit code 1)
};

/// An error a person can act on: where it is, what is wrong, what to do.
struct Error {
  ErrorKind kind = ErrorKind::failed;
  std::string place;    ///< file, or file:line:column, or option name
  std::string problem;  ///< what was found and what was expected
  std::string remedy;   ///< what to do next

  std::string text() const;
};

template <class T>
using Result = std::expected<T, Error>;

inline std::unexpected<Error> usageError(std::string place, std::string problem,
                                         std::string remedy) {
  return std::unexpected(
      Error{ErrorKind::usage, std::move(place), std::move(problem), std::move(remedy)});
}
inline std::unexpected<Error> failure(std::string place, std::string problem, std::string remedy) {
  return std::unexpected(
      Error{ErrorKind::failed, std::move(place), std::move(problem), std::move(remedy)});
}

/// The entry of `known` nearest to `word` by edit distance, or "" when none is near enough
/// (distance > 1 + length/3). For "did you mean".
std::string nearestName(std::string_view word, const std::vector<std::string>& known);

[[noreturn]] void checkFailed(const char* file, int line, const char* expression,
                              const std::string& values);
}  // namespace swallowclip

#define SC_CHECK_OP(a, op, b)                                            \
  do {                                                                   \
    const auto& sc_a_ = (a);                                             \
    const auto& sc_b_ = (b);                                             \
    if (!(sc_a_ op sc_b_))                                               \
      ::swallowclip::checkFailed(__FILE__, __LINE__, #a " " #op " " #b,  \
                                 fmt::format("{} vs {}", sc_a_, sc_b_)); \
  } while (0)
#define CHECK_LT(a, b) SC_CHECK_OP(a, <, b)
#define CHECK_LE(a, b) SC_CHECK_OP(a, <=, b)
#define CHECK_EQ(a, b) SC_CHECK_OP(a, ==, b)
#define CHECK_GT(a, b) SC_CHECK_OP(a, >, b)
