// SPDX-License-Identifier: MIT
// Digests: xxh3 for state (fast, per frame), SHA-256 for files and inputs (manifests).
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace swallowclip {
std::uint64_t stateDigest(const void* data, std::size_t bytes, std::uint64_t seed = 0);
std::string sha256Hex(std::string_view bytes);
}  // namespace swallowclip
