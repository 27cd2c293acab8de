// SPDX-License-Identifier: MIT
// What the rigid parts of the default person are made from: control sections, profiles, dental
// arches and the bony palate. Plain numbers in metres and radians; scenes/*/anatomy.json is read
// into this by scene/anatomy_file.h. Only the left half (x >= 0) is described; the right half is
// its mirror image.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"

namespace swallowclip::anatomy {

/// How an end of a sweep is closed.
enum class Closure {
  midplane,  ///< the end section lies in x = 0 and is stitched to its mirror image
  dome,      ///< rounded cap
  window,    ///< (start only) grows out of a hole in its parent sweep
  loop,      ///< (end only) joined to the first section: hollow rings
};

/// One control section: p(a,b) = at + a u + b v + curl a^2 v/|v|, (a,b) on the profile; where b < 0
/// also ridge b exp(-(a |u| / ridgeHalfWidth)^2) v/|v|.
struct StationDef {
  Vec3 at_m = Vec3::Zero();
  Vec3 u_m = Vec3::UnitX() * 0.01, v_m = Vec3::UnitY() * 0.01;  ///< half axes
  double exponent = 2;  ///< superellipse |a|^e + |b|^e = 1; unused with a named profile
  double curl_m = 0;    ///< bends the section towards v at its u ends (epiglottis)
  std::string profile;  ///< name of a free profile, or empty
  double ridge_m = 0, ridgeHalfWidth_m = 5e-3;  ///< half sections: bump away from v at a = 0
};

/// Hole in the parent: between two of its stations (fractions allowed) and two section angles.
struct WindowDef {
  double station0 = 0, station1 = 1;
  double angle0_rad = 0, angle1_rad = 0;
};

struct SweepDef {
  std::string name;
  std::string parent;  ///< sweep whose window it grows from; only with Closure::window
  WindowDef window;
  bool half = false;    ///< sections run from x = 0 over the left side back to x = 0
  int ringPoints = 16;  ///< per section; a window decides by itself
  double edge_m = 2.5e-3;
  Closure start = Closure::midplane, end = Closure::dome;
  double startDome_m = 5e-4, endDome_m = 5e-4;
  std::vector<StationDef> stations;
};

struct PartDef {
  std::string name, material = "bone";
  Carrier carrier = Carrier::skull;
  bool paired = false;  ///< off the midplane: two structures NAME_L and NAME_R
  Carrier carrierRight = Carrier::skull;
  std::vector<std::string> follows;  ///< soft: moves with the nearest tissue of these structures
  std::vector<SweepDef> sweeps;      ///< parents before children
};

enum class ToothKind { incisor, canine, premolar, molar };

struct ToothDef {
  ToothKind kind = ToothKind::incisor;
  double width_m = 0.008, depth_m = 0.007;  ///< mesiodistal, buccolingual
  double height_m = 0.010;                  ///< crown, cervix to tip
  double tipZ_m = -0.024;
  double lean_rad = 0;  ///< crown towards the lips or cheek
};

/// A row of teeth from the midline backwards; neighbours touch at their widest.
struct DentalArchDef {
  std::string name;
  Carrier carrier = Carrier::skull;
  bool upper = true;
  double root_m = 0.003;            ///< root stub hidden in the bone
  std::vector<Vec2> lingualPlan_m;  ///< (x, y) of the lingual faces, midline first
  std::vector<ToothDef> teeth;
  std::string gumName;        ///< empty: no gum
  double gumMargin_m = 1e-3;  ///< its edge, from the necks towards the tips
};

/// Maxilla: a closed slab between oral palate and nasal floor, with the alveolar process.
struct PalateDef {
  std::string name;                         ///< empty: no maxilla
  std::vector<Vec2> oralMidline_m;          ///< (y, z) of the oral mucosa, front first
  std::vector<Vec2> halfWidth_m;            ///< (y, w)
  std::vector<Vec2> nasalFloor_m;           ///< (y, z), front first
  std::vector<Vec2> lingualPlan_m;          ///< (x, y) inner border of the alveolar process
  std::vector<Vec2> frontRim_m, backRim_m;  ///< (outwards, z) around the alveolar process, in the
                                            ///< midline and at the molars; same count
  double mucosa_m = 8.5e-4;                 ///< bone above the oral mucosa
  double archDrop_m = 9e-3, archExponent = 2.5;  ///< roof = mid - drop (|x|/w)^exponent
  double lowest_m = -0.0170;                     ///< lingual crest: the roof stops here
  double fanFront_m = -0.036;                    ///< y on the midline where the fan starts
  int sections = 22;
  std::string mucosaName;        ///< empty: no mucosa of its own
  std::vector<double> rugaeY_m;  ///< y of the rugae beside the raphe, front first
  double rugaDepth_m = 7e-4;     ///< valleys between them
};

/// A named point, found on the finished mesh.
struct LandmarkDef {
  std::string name, structure;
  enum class Rule { fixed, nearest, extreme, midCentre } rule = Rule::nearest;
  Vec3 value = Vec3::Zero();  ///< metres, or the direction of the extreme
  bool midplane = false;      ///< extreme: among vertices with x = 0 only
};

struct AnatomyDef {
  std::string name;
  std::map<std::string, std::vector<Vec2>> profiles;  ///< closed outlines (a, b), a = 1 first
  std::vector<PartDef> parts;
  std::vector<DentalArchDef> arches;
  PalateDef palate;
  std::vector<LandmarkDef> landmarks;
};
}  // namespace swallowclip::anatomy
