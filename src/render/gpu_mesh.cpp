// SPDX-License-Identifier: MIT
#include "render/gpu_mesh.h"

#include <cstring>

namespace swallowclip::render {

namespace {
GLsizeiptr bytes(const auto& v) {
  return static_cast<GLsizeiptr>(v.size() * sizeof(v[0]));
}

void describeVertex() {
  for (unsigned k = 0; k < 3; ++k) {
    glEnableVertexAttribArray(k);
    glVertexAttribPointer(k, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          reinterpret_cast<const void*>(k * sizeof(Vec3f)));
  }
}
}  // namespace

GpuMesh::~GpuMesh() {
  if (!frame_) return;
  for (const GLuint* a : {&frame_, &extra_, &screen_}) glDeleteVertexArrays(1, a);
  glDeleteBuffers(3, buffers_);
}

void GpuMesh::create() {
  for (GLuint* a : {&frame_, &extra_, &screen_}) glGenVertexArrays(1, a);
  glGenBuffers(3, buffers_);
  glBindVertexArray(frame_);
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[0]);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers_[1]);
  describeVertex();
  glBindVertexArray(extra_);
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[2]);
  describeVertex();
}

void GpuMesh::uploadFrame(const std::vector<Vertex>& vertices) {
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[0]);
  glBufferData(GL_ARRAY_BUFFER, bytes(vertices), vertices.data(), GL_STREAM_DRAW);
}

void GpuMesh::uploadView(const DrawList& list) {
  glBindVertexArray(frame_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes(list.indices), list.indices.data(), GL_STREAM_DRAW);
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[2]);
  glBufferData(GL_ARRAY_BUFFER, bytes(list.extra), list.extra.data(), GL_STREAM_DRAW);
}

void GpuMesh::draw(const Range& r) const {
  if (r.count == 0) return;
  glBindVertexArray(frame_);
  const auto offset = static_cast<std::uintptr_t>(r.firstIndex) * sizeof(std::uint32_t);
  glDrawElementsBaseVertex(GL_TRIANGLES, r.count, GL_UNSIGNED_INT,
                           reinterpret_cast<const void*>(offset), r.firstVertex);
}

void GpuMesh::draw(const Soup& s) const {
  if (s.count == 0) return;
  glBindVertexArray(extra_);
  glDrawArrays(GL_TRIANGLES, s.first, s.count);
}

void GpuMesh::draw(const DrawItem& item) const {
  draw(item.mesh);
  draw(item.skin);
}

void GpuMesh::drawScreen() const {
  glBindVertexArray(screen_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
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
