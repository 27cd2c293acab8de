// SPDX-License-Identifier: MIT
#include "scene/json_text.h"

#include <nlohmann/json.hpp>

#include "core/file.h"

namespace swallowclip::scene {
namespace {
using Json = nlohmann::json;

void dropRemarks(Json& j) {
  if (j.is_object()) {
    j.erase("comment");
    j.erase("source");
  }
  for (Json& child : j)
    if (child.is_structured()) dropRemarks(child);
}
}  // namespace

std::string quotedJson(std::string_view text) {
  return Json(std::string(text)).dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<std::string> canonicalJson(const std::filesystem::path& path, const std::string& list,
                                  const std::string& member) {
  auto text = readFile(path);
  if (!text) return std::unexpected(text.error());
  Json j = Json::parse(*text, nullptr, false);
  if (j.is_discarded())
    return usageError(path.string(), "not valid JSON", "`swallowclip check` says where.");
  dropRemarks(j);
  if (!list.empty() && j.is_object() && j.contains(list) && j[list].is_object()) {
    Json& all = j[list];
    all = all.contains(member) ? Json{{member, all[member]}} : Json::object();
  }
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}
}  // namespace swallowclip::scene
