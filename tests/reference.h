// SPDX-License-Identifier: MIT
// Where the reference meshes lie: SWALLOWCLIP_REFERENCE, or beside the repository. They never enter
// it, so tests that use them skip when the folder is absent.
#pragma once
#include <cstdlib>
#include <filesystem>

namespace swallowclip::test {

inline std::filesystem::path referenceFolder() {
  if (const char* set = std::getenv("SWALLOWCLIP_REFERENCE")) return set;
  return SWALLOWCLIP_SOURCE_DIR "/../shared/reference-anatomy";
}
}  // namespace swallowclip::test
