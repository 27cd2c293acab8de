// SPDX-License-Identifier: MIT
#include "pipeline/scene_loader.h"

#include <algorithm>

#include "anatomy/anatomy_builder.h"
#include "scene/anatomy_file.h"
#include "scene/lumen_file.h"
#include "scene/mapping_file.h"

namespace swallowclip::pipeline {
namespace {
Result<void> loadBones(const std::filesystem::path& folder, LoadedScene& scene) {
  if (!scene::isImportedScene(folder)) {
    scene.files.push_back(folder / "anatomy.json");
    auto def = scene::loadAnatomyDef(scene.files.back());
    if (!def) return std::unexpected(def.error());
    auto built = anatomy::buildRigidParts(*def);
    if (!built) return std::unexpected(built.error());
    scene.rigid = std::move(*built);
    return {};
  }
  scene.files.push_back(folder / "scene.json");
  auto imported = scene::loadImportedScene(folder);
  if (!imported) return std::unexpected(imported.error());
  for (anatomy::Structure& s : imported->anatomy.structures) {
    if (s.rigid || s.carrier == anatomy::Carrier::epiglottis)
      scene.rigid.structures.push_back(std::move(s));
    else
      scene.notes.push_back(fmt::format(
          "{}: soft structure without a motion of its own, the parametric one is used", s.name));
  }
  scene.rigid.landmarks = std::move(imported->anatomy.landmarks);
  return {};
}

// A soft part follows tissue with a motion of its own, not another follower.
Result<void> checkFollowed(const LoadedScene& scene) {
  std::vector<std::string> known;
  for (const anatomy::Structure& s : scene.soft->structures()) known.push_back(s.name);
  for (const anatomy::Structure& s : scene.rigid.structures)
    if (s.follows.empty()) known.push_back(s.name);
  for (const anatomy::Structure& s : scene.rigid.structures)
    for (const std::string& name : s.follows) {
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      const std::string near = nearestName(name, known);
      return usageError("structure " + s.name, fmt::format("it cannot follow \"{}\"", name),
                        near.empty() ? "name structures that move by themselves"
                                     : "did you mean \"" + near + "\"?");
    }
  return {};
}
}  // namespace

Result<LoadedScene> loadScene(const RunOptions& options) {
  LoadedScene scene;
  const std::filesystem::path folder = options.sceneFolder();
  std::error_code ec;
  if (!std::filesystem::is_directory(folder, ec))
    return usageError(folder.string(), "no such scene folder", "See 'swallowclip list scenes'.");
  if (auto bones = loadBones(folder, scene); !bones) return std::unexpected(bones.error());
  const auto softFolder =
      scene::isImportedScene(folder) ? options.scenesFolder() / "adult" : folder;
  scene.files.push_back(softFolder / "lumen.json");
  auto lumen = scene::loadLumenDef(scene.files.back());
  if (!lumen) return std::unexpected(lumen.error());
  scene.files.push_back(softFolder / "soft.json");
  auto soft = scene::loadSoftDef(scene.files.back());
  if (!soft) return std::unexpected(soft.error());
  scene.lumen = std::make_unique<anatomy::Lumen>(std::move(*lumen));
  scene.soft = std::make_unique<anatomy::SoftParts>(*scene.lumen, std::move(*soft));
  if (auto good = checkFollowed(scene); !good) return std::unexpected(good.error());
  return scene;
}
}  // namespace swallowclip::pipeline
