// SPDX-License-Identifier: MIT
// Sequential meshes: every structure's vertices at evenly spaced times, baked from a swallow file
// or imported from numbered files. Vertex k of a structure is the same tissue point in all frames.
#pragma once
#include <string>
#include <vector>

#include "core/tri_mesh.h"

namespace swallowclip::kinematics {

struct StructureSequence {
  std::string name, material;
  bool rigid = true;
  std::vector<Triangle> triangles;
  std::vector<Vec3> rest;                 ///< bind pose (neutral, every lumen open)
  std::vector<std::vector<Vec3>> frames;  ///< [frame][vertex], m
};

struct MeshSequence {
  double start_s = 0;   ///< time of frame 0 (cue = 0)
  double rate_hz = 34;  ///< 109 frames over 3.18 s, thesis 3.2
  std::vector<StructureSequence> structures;

  int frames() const {
    return structures.empty() ? 0 : static_cast<int>(structures.front().frames.size());
  }
  double end_s() const { return start_s + (frames() - 1) / rate_hz; }
};

/// C1 interpolation in time of one scalar sequence with shape-preserving tangents (Fritsch &
/// Carlson 1980): never overshoots its samples, so a closed gap stays closed between frames.
/// Writes position and velocity of `count` packed scalars of frames f..; see mesh_sequence.cpp.
struct HermiteWeights {
  int frame = 0;  ///< interval [frame, frame+1]
  double x = 0;   ///< 0..1 inside it
};
HermiteWeights locate(double t_s, double start_s, double rate_hz, int frames);

/// Precomputed tangents of a vertex sequence; sampling it is C1 in t and gives the exact velocity.
class SequenceSampler {
 public:
  SequenceSampler(double start_s, double rate_hz, std::vector<std::vector<Vec3>> frames);
  void at(double t_s, std::vector<Vec3>& positions, std::vector<Vec3>& velocities) const;
  int frames() const { return static_cast<int>(frames_.size()); }

 private:
  double start_s_, rate_hz_;
  std::vector<std::vector<Vec3>> frames_, tangents_;  ///< tangents per frame interval (m/frame)
};
}  // namespace swallowclip::kinematics
