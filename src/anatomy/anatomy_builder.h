// SPDX-License-Identifier: MIT
// Definition -> closed, outward facing meshes of bones, cartilages and teeth, with landmarks.
//
//   auto def = scene::loadAnatomyDef("scenes/adult/anatomy.json");
//   auto rigid = anatomy::buildRigidParts(*def);
//
// Every structure is exactly symmetric (single ones in themselves, paired ones L to R), a closed
// 2-manifold per checkManifold and of positive volume. Teeth form one structure per jaw.
#pragma once
#include "anatomy/anatomy_def.h"
#include "core/error.h"

namespace swallowclip::anatomy {
Result<Anatomy> buildRigidParts(const AnatomyDef& def);
}  // namespace swallowclip::anatomy
