// SPDX-License-Identifier: MIT
#include "library/sealed.h"

#include "core/digest.h"
#include "core/file.h"

namespace swallowclip::library {
namespace {
constexpr std::string_view kSeal = ",\n\"seal\": \"";
}

std::string sealed(const std::string& members) {
  const std::string body = "{\n" + members;
  return body + std::string(kSeal) + sha256Hex(body) + "\"\n}\n";
}

Result<scene::JsonFile> readSealed(const std::filesystem::path& file) {
  auto text = readFile(file);
  if (!text) return std::unexpected(text.error());
  const std::size_t at = text->rfind(kSeal);
  const bool whole =
      at != std::string::npos && text->substr(at + kSeal.size()) ==
                                     sha256Hex(std::string_view(*text).substr(0, at)) + "\"\n}\n";
  if (!whole)
    return failure(file.string(), "cut or changed since it was written",
                   "`swallowclip nightly` makes it anew.");
  auto json = scene::JsonFile::parse(std::move(*text), file.string());
  if (json) json->root().text("seal");  // read here, so that no one else has to
  return json;
}
}  // namespace swallowclip::library
