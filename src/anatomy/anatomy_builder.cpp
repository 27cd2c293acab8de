// SPDX-License-Identifier: MIT
#include "anatomy/anatomy_builder.h"

#include <limits>

#include "anatomy/oral_mucosa.h"
#include "anatomy/rigid_parts.h"

namespace swallowclip::anatomy {
namespace {

Result<void> addWhole(Anatomy& out, Structure structure, const Result<HalfSurface>& half) {
  if (!half) return std::unexpected(half.error());
  auto mesh = half->mirrored(structure.name);
  if (!mesh) return std::unexpected(mesh.error());
  structure.mesh = std::move(*mesh);
  out.structures.push_back(std::move(structure));
  return {};
}

Result<void> addPart(Anatomy& out, const AnatomyDef& def, const PartDef& part) {
  const auto half = sweepPart(part, def.profiles);
  const bool rigid = part.follows.empty();
  if (!part.paired)
    return addWhole(out, {part.name, part.material, rigid, part.carrier, false, {}, part.follows},
                    half);
  if (!half) return std::unexpected(half.error());
  auto pair = half->leftAndRight(part.name);
  if (!pair) return std::unexpected(pair.error());
  out.structures.push_back({part.name + "_L", part.material, rigid, part.carrier, false,
                            std::move(pair->first), part.follows});
  out.structures.push_back({part.name + "_R", part.material, rigid, part.carrierRight, false,
                            std::move(pair->second), part.follows});
  return {};
}

Vec3 measure(const TriMesh& mesh, const LandmarkDef& landmark) {
  Vec3 best = Vec3::Zero(), sum = Vec3::Zero();
  double least = std::numeric_limits<double>::max();
  int count = 0;
  for (const Vec3& p : mesh.positions) {
    if (p.x() == 0) {
      sum += p;
      ++count;
    } else if (landmark.midplane) {
      continue;
    }
    const double cost = landmark.rule == LandmarkDef::Rule::extreme
                            ? -p.dot(landmark.value)
                            : (p - landmark.value).squaredNorm();
    if (cost < least) {
      least = cost;
      best = p;
    }
  }
  if (landmark.rule == LandmarkDef::Rule::midCentre && count > 0) return sum / count;
  return best;
}

Result<void> addLandmarks(Anatomy& out, const AnatomyDef& def) {
  std::vector<std::string> names;
  for (const Structure& s : out.structures) names.push_back(s.name);
  for (const LandmarkDef& landmark : def.landmarks) {
    if (landmark.rule == LandmarkDef::Rule::fixed) {
      out.landmarks[landmark.name] = landmark.value;
      continue;
    }
    const Structure* structure = out.find(landmark.structure);
    if (!structure) {
      const std::string near = nearestName(landmark.structure, names);
      return usageError("landmark " + landmark.name,
                        fmt::format("there is no structure \"{}\"", landmark.structure),
                        near.empty() ? "name one of the parts" : "did you mean \"" + near + "\"?");
    }
    out.landmarks[landmark.name] = measure(structure->mesh, landmark);
  }
  return {};
}
}  // namespace

Result<Anatomy> buildRigidParts(const AnatomyDef& def) {
  Anatomy out;
  if (!def.palate.name.empty())
    if (auto done = addWhole(out, {def.palate.name, "bone", true, Carrier::skull, false, {}},
                             maxilla(def.palate));
        !done)
      return std::unexpected(done.error());
  for (const DentalArchDef& arch : def.arches)
    if (auto done =
            addWhole(out, {arch.name, "enamel", true, arch.carrier, false, {}}, dentalArch(arch));
        !done)
      return std::unexpected(done.error());
  if (!def.palate.mucosaName.empty())
    if (auto done =
            addWhole(out, {def.palate.mucosaName, "mucosa", true, Carrier::skull, false, {}},
                     palateMucosa(def.palate));
        !done)
      return std::unexpected(done.error());
  for (const DentalArchDef& arch : def.arches)
    if (!arch.gumName.empty())
      if (auto done =
              addWhole(out, {arch.gumName, "mucosa", true, arch.carrier, false, {}}, gum(arch));
          !done)
        return std::unexpected(done.error());
  for (const PartDef& part : def.parts)
    if (auto done = addPart(out, def, part); !done) return std::unexpected(done.error());
  if (auto done = addLandmarks(out, def); !done) return std::unexpected(done.error());
  return out;
}
}  // namespace swallowclip::anatomy
