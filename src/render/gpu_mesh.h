// SPDX-License-Identifier: MIT
// Triangles on their way to GL, and pictures on their way back.
#pragma once
#include "core/image.h"
#include "render/draw_list.h"
#include "render/gl.h"

namespace swallowclip::render {

/// A frame's vertices, uploaded once, and what one view at a time draws of them.
class GpuMesh {
 public:
  GpuMesh() = default;
  ~GpuMesh();
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;
  void create();
  void uploadFrame(const std::vector<Vertex>& vertices);
  void uploadView(const DrawList& list);
  void draw(const Range& range) const;
  void draw(const Soup& soup) const;
  /// Its mesh, or its skin.
  void draw(const DrawItem& item) const;
  /// One triangle over the whole picture, for shaders/screen.vert.
  void drawScreen() const;

 private:
  GLuint frame_ = 0, extra_ = 0, screen_ = 0;  // vertex arrays
  GLuint buffers_[3] = {};                     // the frame's vertices, indices, extra vertices
};

/// Reads the bound framebuffer, top row first.
Image readPicture(int width, int height);

/// GL's own verdict on what was drawn since the last call.
Result<void> checkedGl(const char* what);
}  // namespace swallowclip::render
