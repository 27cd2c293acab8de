// SPDX-License-Identifier: MIT
#include "library/versions.h"

#include <link.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <string_view>
#include <vector>

#include "library/stage_versions.h"

namespace swallowclip::library {
namespace {
using Words = std::vector<std::string_view>;

/// Libraries whose code decides bytes of a stage's products; name up to ".so".
Words librariesOf(Stage stage) {
  Words words{"libc", "libm", "libstdc++", "libhdf5_serial", "libz", "libsz", "libaec"};
  const auto add = [&](const Words& more) { words.insert(words.end(), more.begin(), more.end()); };
  switch (stage) {
    case Stage::bake:
    case Stage::simulate:
      add({"libassimp", "libgmp", "libmpfr"});
      break;
    case Stage::measure:
      break;
    case Stage::draw:
      add({"libOSMesa", "libglapi", "libLLVM-15", "libcairo", "libpango-1.0", "libpangocairo-1.0",
           "libpangoft2-1.0", "libharfbuzz", "libfreetype", "libfontconfig", "libpixman-1"});
      [[fallthrough]];
    case Stage::verify:
      add({"libavcodec", "libavformat", "libavutil", "libswscale", "libx264", "libpng16"});
      break;
  }
  return words;
}

std::string hex(const unsigned char* bytes, std::size_t count) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) text += fmt::format("{:02x}", bytes[k]);
  return text;
}

/// The GNU build id in a loaded object's notes, "" when it has none.
std::string buildId(const dl_phdr_info& object) {
  for (int k = 0; k < object.dlpi_phnum; ++k) {
    const ElfW(Phdr)& header = object.dlpi_phdr[k];
    if (header.p_type != PT_NOTE) continue;
    const auto* at = reinterpret_cast<const unsigned char*>(object.dlpi_addr + header.p_vaddr);
    const auto* end = at + header.p_memsz;
    while (at + sizeof(ElfW(Nhdr)) <= end) {
      ElfW(Nhdr) note;
      std::memcpy(&note, at, sizeof note);
      const auto padded = [](std::size_t n) { return (n + 3) & ~std::size_t{3}; };
      const unsigned char* name = at + sizeof note;
      const unsigned char* value = name + padded(note.n_namesz);
      if (value + note.n_descsz > end) break;
      if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && !std::memcmp(name, "GNU", 4))
        return hex(value, note.n_descsz);
      at = value + padded(note.n_descsz);
    }
  }
  return "";
}

int collect(dl_phdr_info* object, std::size_t, void* into) {
  auto& all = *static_cast<std::map<std::string, std::string>*>(into);
  const std::string file = std::filesystem::path(object->dlpi_name).filename().string();
  if (file.find(".so") != std::string::npos) all[file] = buildId(*object);
  return 0;
}
}  // namespace

std::string sourceVersion(Stage stage) {
  switch (stage) {
    case Stage::bake:
    case Stage::simulate:
      return simulateDigest;
    case Stage::measure:
      return measureDigest;
    case Stage::draw:
      return drawDigest;
    case Stage::verify:
      break;
  }
  return verifyDigest;
}

std::string libraryVersions(Stage stage) {
  static const std::map<std::string, std::string> loaded = [] {
    std::map<std::string, std::string> all;
    dl_iterate_phdr(&collect, &all);
    return all;
  }();
  const Words wanted = librariesOf(stage);
  std::string text;
  for (const auto& [file, id] : loaded)
    if (std::ranges::find(wanted, std::string_view(file).substr(0, file.find(".so"))) !=
        wanted.end())
      text += fmt::format("{}{}={}", text.empty() ? "" : " ", file, id);
  return text;
}
}  // namespace swallowclip::library
