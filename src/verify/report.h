// SPDX-License-Identifier: MIT
// Results for people (table, charts) and for machines (JSON).
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "verify/result.h"

namespace swallowclip::verify {

std::string tableHead();
/// The rows of one case, each ended by a line break.
std::string tableRows(const CaseResult& result);
std::string resultsJson(const std::vector<CaseResult>& results);
/// NAME.svg and NAME.png, one pair per check (NAME-2.svg for the second).
Result<void> writeCharts(const CaseResult& result, const std::filesystem::path& folder);
}  // namespace swallowclip::verify
