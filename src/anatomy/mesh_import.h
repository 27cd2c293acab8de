// SPDX-License-Identifier: MIT
// Meshes of other people made into an Anatomy: any file that assimp reads, half-cut or whole, in
// any unit and axes, still or as numbered files. What was assumed, guessed or mended is said in
// `report`. In: files and an ImportDef (scene/mapping_file reads it from JSON). Out: metres, frame
// of core/vec.h.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/mesh_repair.h"
#include "core/error.h"

namespace swallowclip::anatomy {

enum class LengthUnit { mm, cm, m, guess };

struct AxesDef {
  bool guess = true;
  Mat3 oursFromFile =
      Mat3::Identity();  ///< signed permutation; a mirroring one turns triangles round
};

struct ImportStructureDef {
  /// Relative to the source folder; one still mesh, a list of frames, or one pattern such as
  /// tongue_%04d.obj. Empty: the source itself is the file.
  std::vector<std::string> files;
  std::string object;  ///< named object (node or mesh) inside the file; "" takes them all
  std::string name;    ///< unique: tongue, mandible ...
  std::string material = "bone";
  bool rigid = true;
  Carrier carrier = Carrier::skull;
  HalfSide half = HalfSide::guess;
  SurfaceClosure closure = SurfaceClosure::requireClosed;
};

struct ImportDef {
  LengthUnit unit = LengthUnit::guess;
  AxesDef axes;
  Vec3 origin_m = Vec3::Zero();       ///< point of the turned file that becomes our origin (PNS)
  double stitchTolerance_m = 0.2e-3;  ///< to the midsagittal plane; assumed, sensible 0.05-0.5 mm
  double start_s = 0, rate_hz = 34;   ///< of sequences; 34/s as kinematics/mesh_sequence.h
  std::map<std::string, Vec3> landmarks;  ///< already in our frame, m
  std::vector<ImportStructureDef> structures;
};

/// Frames of one structure; vertex k is the same tissue point in all of them, and of
/// Structure::mesh, which is frame 0.
struct ImportedSequence {
  std::string name;
  std::vector<std::vector<Vec3>> frames;
};

struct ImportedScene {
  Anatomy anatomy;
  double start_s = 0, rate_hz = 34;
  std::vector<ImportedSequence> sequences;
  std::vector<std::string> report;  ///< one line per thing a person should know
};

/// `source` is a folder, or one file with named objects.
Result<ImportedScene> importMeshes(const std::filesystem::path& source, const ImportDef& def);

/// One file (or the named object in it) as it is: its own unit and axes, nothing welded.
Result<RawMesh> readMeshFile(const std::filesystem::path& file, const std::string& object);

/// Unit (metres per file unit) that makes the structures nearest to adult size; fails when even the
/// best is more than a factor 2.5 off. `extents`: largest bounding-box side by structure name.
Result<double> guessUnit(const std::map<std::string, double>& extents, const std::string& place);

/// Rotation that puts what lies above above and what lies behind behind, from structure centres;
/// never mirrors, since left and right can't be seen in a symmetric anatomy.
Result<Mat3> guessAxes(const std::map<std::string, Vec3>& centres, const std::string& place);
/// "x is left, y is posterior, z is superior" for the three file axes.
std::string axesText(const Mat3& oursFromFile);
}  // namespace swallowclip::anatomy
