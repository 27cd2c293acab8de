// SPDX-License-Identifier: MIT
// GL names for this room only. libOSMesa exports GL itself, so prototypes suffice (neither libGL
// nor a loader may be linked); the direct-state-access functions of 4.5 are not among its exports.
#pragma once
#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#endif
#include <GL/gl.h>
#include <GL/glext.h>

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/vec.h"

namespace swallowclip::render {

using Mat4f = Eigen::Matrix4f;

/// A linked GLSL program with its uniforms by name. A uniform that a stage does not use is
/// skipped silently, as GL does.
class Program {
 public:
  Program() = default;
  /// Links `vertex` and `fragment` files of the folder; `define`, if any, is defined in the latter.
  static Result<Program> load(const std::filesystem::path& shaderDir, const std::string& vertex,
                              const std::string& fragment, const std::string& define = "");
  ~Program();
  Program(Program&& b) noexcept { swap(b); }
  Program& operator=(Program&& b) noexcept {
    swap(b);
    return *this;
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const { glUseProgram(id_); }
  void set(const char* name, int v) { glUniform1i(at(name), v); }
  void set(const char* name, float v) { glUniform1f(at(name), v); }
  void set(const char* name, const Eigen::Vector2f& v) { glUniform2fv(at(name), 1, v.data()); }
  void set(const char* name, const Eigen::Vector2i& v) { glUniform2iv(at(name), 1, v.data()); }
  void set(const char* name, const Vec3f& v) { glUniform3fv(at(name), 1, v.data()); }
  void set(const char* name, const Eigen::Vector4f& v) { glUniform4fv(at(name), 1, v.data()); }
  void set(const char* name, const Mat4f& m) {
    glUniformMatrix4fv(at(name), 1, GL_FALSE, m.data());
  }

 private:
  int at(const char* name);
  void swap(Program& b) noexcept {
    std::swap(id_, b.id_);
    std::swap(locations_, b.locations_);
  }
  GLuint id_ = 0;
  std::map<std::string, int, std::less<>> locations_;
};

/// A texture owned by one object.
class Texture {
 public:
  Texture() = default;
  ~Texture() { reset(); }
  Texture(Texture&& b) noexcept { std::swap(id_, b.id_); }
  Texture& operator=(Texture&& b) noexcept {
    std::swap(id_, b.id_);
    return *this;
  }
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  /// Immutable storage.
  void create(GLenum format, int width, int height, GLenum filter);
  void bind(int unit) const;
  GLuint id() const { return id_; }

 private:
  void reset() {
    if (id_) glDeleteTextures(1, &id_);
    id_ = 0;
  }
  GLuint id_ = 0;
};

/// A framebuffer of at most one colour and one depth texture.
class Target {
 public:
  Target() = default;
  ~Target();
  Target(Target&& b) noexcept
      : id_(std::exchange(b.id_, 0)),
        width_(b.width_),
        height_(b.height_),
        colour_(std::move(b.colour_)),
        depth_(std::move(b.depth_)) {}
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  /// A format of 0 leaves that attachment out.
  Result<void> create(const char* what, int width, int height, GLenum colourFormat,
                      GLenum depthFormat);
  /// Depth of another target of the same size, to be tested and not written.
  void testAgainst(const Target& other);
  /// Takes over the depth (and stencil) of another target of the same size and format.
  void copyDepth(const Target& other);
  void bind() const;
  const Texture& colour() const { return colour_; }
  const Texture& depth() const { return depth_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  GLuint id_ = 0;
  int width_ = 0, height_ = 0;
  Texture colour_, depth_;
};
}  // namespace swallowclip::render
