// SPDX-License-Identifier: MIT
// Rest geometry of one person: closed meshes by structure, landmarks, all in metres in the frame of
// core/vec.h. Immutable once built.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/tri_mesh.h"

namespace swallowclip::anatomy {

/// Which rigid frame a structure rides on (kinematics moves these frames).
enum class Carrier { skull, mandible, hyoid, thyroid, cricoid, arytenoidL, arytenoidR, epiglottis };

struct Structure {
  std::string name;      ///< tongue, mandible, lower_teeth, maxilla, upper_teeth, hyoid, c2 ...
  std::string material;  ///< muscle, mucosa, bone, cartilage, enamel
  bool rigid = true;
  Carrier carrier = Carrier::skull;  ///< rigid ones only
  bool drawOnly = false;             ///< not closed: drawn, never used for mass or walls
  TriMesh mesh;
  std::vector<std::string> follows =
      {};  ///< soft parts outside the lumen: structures that carry it
};

struct Anatomy {
  std::vector<Structure> structures;
  std::map<std::string, Vec3>
      landmarks;  ///< names of reference-anatomy/landmarks.json where shared

  const Structure* find(const std::string& name) const {
    for (const Structure& s : structures)
      if (s.name == name) return &s;
    return nullptr;
  }
};
}  // namespace swallowclip::anatomy
