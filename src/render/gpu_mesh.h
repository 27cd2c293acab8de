// SPDX-License-Identifier: MIT
// Triangles on their way to GL, and pictures on their way back.
#pragma once
#include "core/image.h"
#include "render/draw_list.h"
#include "render/gl.h"

namespace swallowclip::render {

/// Vertex and index buffers filled anew for each frame.
class GpuMesh {
 public:
  GpuMesh() = default;
  ~GpuMesh();
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;
  void create();
  void upload(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& indices);
  void draw(const Range& range) const;

 private:
  GLuint array_ = 0, vertices_ = 0, indices_ = 0;
};

/// Reads the bound framebuffer, top row first.
Image readPicture(int width, int height);

/// GL's own verdict on what was drawn since the last call.
Result<void> checkedGl(const char* what);
}  // namespace swallowclip::render
