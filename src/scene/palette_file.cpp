// SPDX-License-Identifier: MIT
#include "scene/palette_file.h"

#include <algorithm>

#include "render/colour_vision.h"

namespace swallowclip::scene {
namespace {
using render::Colour;

void requireApart(const JsonNode& list, const Palette& palette, double least) {
  std::vector<std::string> names;
  for (const JsonNode& entry : list.asArray()) {
    const std::string name = entry.asText();
    if (!palette.contains(name)) {
      entry.fail(fmt::format("\"{}\" is not in this palette", name),
                 "Name colours of \"palette\".");
      return;
    }
    names.push_back(name);
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t k = i + 1; k < names.size(); ++k)
      for (const render::Vision v : render::kVisions) {
        const double difference = render::colourDifference(render::seenBy(v, palette.at(names[i])),
                                                           render::seenBy(v, palette.at(names[k])));
        if (difference < least)
          list.fail(
              fmt::format("\"{}\" and \"{}\" differ by {:.1f} to {} eyes, at least {} expected",
                          names[i], names[k], difference, render::name(v), least),
              "Move them apart, best in lightness.");
      }
}
}  // namespace

Colour readColour(const JsonNode& node, std::string_view key, const Colour& defaultValue,
                  const Palette& palette) {
  if (!node.has(key)) return defaultValue;
  const JsonNode value = node.member(key);
  if (value.isArray()) {
    const std::vector<double> c = value.asNumbers();
    const bool inRange = std::ranges::all_of(c, [](double v) { return v >= 0 && v <= 1; });
    if (c.size() == 3 && inRange) return Colour(float(c[0]), float(c[1]), float(c[2]));
  } else {
    const std::string text = value.asText();
    if (text.size() == 7 && text[0] == '#' &&
        text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos) {
      const unsigned long rgb = std::stoul(text.substr(1), nullptr, 16);
      return Colour(float(rgb >> 16 & 255), float(rgb >> 8 & 255), float(rgb & 255)) / 255.0f;
    }
    if (const auto it = palette.find(text); it != palette.end()) return it->second;
    std::vector<std::string> known;
    for (const auto& [name, colour] : palette) known.push_back(name);
    if (const std::string near = nearestName(text, known); !near.empty()) {
      value.fail(fmt::format("\"{}\": the palette has no colour \"{}\"", key, text),
                 fmt::format("Did you mean \"{}\"?", near));
      return defaultValue;
    }
  }
  value.fail(fmt::format("\"{}\": not a colour", key),
             palette.empty()
                 ? "Write \"#rrggbb\" or [r, g, b] with 0 to 1."
                 : "Write \"#rrggbb\", [r, g, b] with 0 to 1, or a name of the palette.");
  return defaultValue;
}

Result<std::filesystem::path> palettePath(const std::filesystem::path& presetsFolder,
                                          const std::string& nameOrFile) {
  if (nameOrFile.ends_with(".json")) return nameOrFile;
  const std::filesystem::path path = presetsFolder / "palettes" / (nameOrFile + ".json");
  std::vector<std::string> known;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(path.parent_path(), error))
    known.push_back(entry.path().stem().string());
  std::ranges::sort(known);
  if (std::ranges::find(known, nameOrFile) != known.end()) return path;
  const std::string near = nearestName(nameOrFile, known);
  return usageError("palette", fmt::format("unknown palette \"{}\"", nameOrFile),
                    near.empty()
                        ? fmt::format("Known: {}; or a .json file.", fmt::join(known, ", "))
                        : fmt::format("Did you mean \"{}\"?", near));
}

Result<Palette> loadPalette(const std::filesystem::path& presetsFolder,
                            const std::string& nameOrFile) {
  auto path = palettePath(presetsFolder, nameOrFile);
  if (!path) return std::unexpected(path.error());
  auto file = JsonFile::load(*path);
  if (!file) return std::unexpected(file.error());
  const JsonNode root = file->root();
  Palette palette;
  const JsonNode colours = root.object("palette");
  for (const auto& [name, node] : colours.members())
    palette[name] = readColour(colours, name, Colour::Zero(), {});
  // 10: told apart at a glance on thin outlines and small areas; assumed 8..15
  const double least = root.number("leastDifference", 0, 100, 10);
  if (root.has("apart"))
    for (const JsonNode& list : root.array("apart")) requireApart(list, palette, least);
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return palette;
}
}  // namespace swallowclip::scene
