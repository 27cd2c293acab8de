// SPDX-License-Identifier: MIT
#include "render/gpu_mesh.h"

#include <cstring>

namespace swallowclip::render {

GpuMesh::~GpuMesh() {
  if (!array_) return;
  glDeleteVertexArrays(1, &array_);
  glDeleteBuffers(1, &vertices_);
  glDeleteBuffers(1, &indices_);
}

void GpuMesh::create() {
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &vertices_);
  glGenBuffers(1, &indices_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  for (unsigned k = 0; k < 3; ++k) {
    glEnableVertexAttribArray(k);
    glVertexAttribPointer(k, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          reinterpret_cast<const void*>(k * sizeof(Vec3f)));
  }
}

void GpuMesh::upload(const std::vector<Vertex>& vertices,
                     const std::vector<std::uint32_t>& indices) {
  const auto bytes = [](const auto& v) { return static_cast<GLsizeiptr>(v.size() * sizeof(v[0])); };
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, bytes(vertices), vertices.data(), GL_STREAM_DRAW);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes(indices), indices.data(), GL_STREAM_DRAW);
}

void GpuMesh::draw(const Range& r) const {
  if (r.count == 0) return;
  glBindVertexArray(array_);
  const auto offset = static_cast<std::uintptr_t>(r.firstIndex) * sizeof(std::uint32_t);
  glDrawElementsBaseVertex(GL_TRIANGLES, r.count, GL_UNSIGNED_INT,
                           reinterpret_cast<const void*>(offset), r.firstVertex);
}

Image readPicture(int width, int height) {
  Image image(width, height), flipped(width, height);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, flipped.rgba.data());
  const std::size_t bytes = static_cast<std::size_t>(width) * 4;
  for (int y = 0; y < height; ++y) std::memcpy(image.row(y), flipped.row(height - 1 - y), bytes);
  return image;
}

Result<void> checkedGl(const char* what) {
  const GLenum e = glGetError();
  if (e == GL_NO_ERROR) return {};
  return failure("OpenGL", fmt::format("error 0x{:04x} while drawing {}", e, what),
                 "Report it with the preset and the driver's version.");
}
}  // namespace swallowclip::render
