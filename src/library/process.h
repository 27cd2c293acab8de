// SPDX-License-Identifier: MIT
// Another program, run and listened to.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "core/error.h"

namespace swallowclip::library {

/// Runs words[0] (found by PATH) and hands over every line of its standard output and error as it
/// comes. Returns the exit code, 128 + signal when one ended it. An interrupt (Ctrl-C, SIGTERM) is
/// passed on, and the end waited for. The child gets SIGTERM should we die.
Result<int> runChild(const std::vector<std::string>& words,
                     const std::function<void(const std::string&)>& line);

/// An error that says what to install when `program` isn't there.
Result<void> findProgram(const std::string& program, const std::string& package);

/// For a shell: in single quotes.
std::string shellQuoted(const std::string& word);

/// The program that is running now.
std::string ownProgram();
}  // namespace swallowclip::library
