// SPDX-License-Identifier: MIT
// mapping.json -> ImportDef, and imported scenes on disk (docs/import.md):
//   scenes/mine/scene.json            kind "imported": structures, landmarks, report
//   scenes/mine/meshes-DIGEST/*.ply   binary PLY, doubles, metres, our frame
// scene.json is renamed into place last and names its mesh folder, so that an interrupted import
// leaves the former scene whole.
#pragma once
#include <filesystem>

#include "anatomy/mesh_import.h"
#include "core/error.h"

namespace swallowclip::scene {

Result<anatomy::ImportDef> loadMapping(const std::filesystem::path& path);

/// Same scene, same bytes. Removes mesh folders of former imports once the new scene stands.
Result<void> saveImportedScene(const anatomy::ImportedScene& scene,
                               const std::filesystem::path& folder);
Result<anatomy::ImportedScene> loadImportedScene(const std::filesystem::path& folder);
/// True when `folder`/scene.json says that it holds an imported scene.
bool isImportedScene(const std::filesystem::path& folder);

/// `swallowclip import`: all of it; nothing is written unless everything could be read.
Result<anatomy::ImportedScene> importScene(const std::filesystem::path& source,
                                           const std::filesystem::path& mapping,
                                           const std::filesystem::path& out);
}  // namespace swallowclip::scene
