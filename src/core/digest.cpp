// SPDX-License-Identifier: MIT
#include "core/digest.h"

#include <fmt/format.h>
#include <openssl/sha.h>
#include <xxhash.h>

namespace swallowclip {

std::uint64_t stateDigest(const void* data, std::size_t bytes, std::uint64_t seed) {
  return XXH3_64bits_withSeed(data, bytes, seed);
}

std::string sha256Hex(std::string_view bytes) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest);
  std::string hex;
  for (unsigned char c : digest) hex += fmt::format("{:02x}", c);
  return hex;
}
}  // namespace swallowclip
