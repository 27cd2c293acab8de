// SPDX-License-Identifier: MIT
// The JSON reader against any bytes: parses them, walks what came out, asks for keys of every kind.
// Nothing may crash, hang or be read beyond its end; errors must be printable UTF-8 lines.
#include <cstdint>
#include <cstdlib>

#include "scene/json_reader.h"

using swallowclip::scene::JsonFile;
using swallowclip::scene::JsonNode;

namespace {
void walk(const JsonNode& node, int depth) {
  if (depth > 70) std::abort();  // the reader promises 64 levels
  if (node.isObject()) {
    node.has("a");
    node.number("a", -1, 1, 0);
    node.choice("b", {"sun", "moon"}, "sun");
    for (const auto& [key, child] : node.members()) walk(child, depth + 1);
  } else if (node.isArray()) {
    for (const JsonNode& child : node.asArray()) walk(child, depth + 1);
  } else if (node.isNumber()) {
    const double value = node.asNumber(-1e300, 1e300);
    if (!(value >= -1e300 && value <= 1e300)) std::abort();
  } else if (node.isText()) {
    if (node.asText().find('\0') != std::string::npos) std::abort();
  }
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  auto file = JsonFile::parse(text, "fuzz.json");
  if (!file) {
    if (file.error().text().empty()) std::abort();
    return 0;
  }
  walk(file->root(), 0);
  (void)file->finish();
  // A second reading asks for what is likely missing or of another kind.
  auto again = JsonFile::parse(text, "fuzz.json");
  const JsonNode root = again->root();
  root.vec3("v");
  root.points2("p");
  root.object("o").array("l");
  if (const auto done = again->finish(); !done && done.error().place.empty()) std::abort();
  return 0;
}
