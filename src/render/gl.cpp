// SPDX-License-Identifier: MIT
#include "render/gl.h"

#include <algorithm>
#include <vector>

#include "core/file.h"

namespace swallowclip::render {
namespace {

template <class GetLength, class GetText>
std::string infoLog(GLuint id, GetLength length, GetText text) {
  GLint n = 0;
  length(id, GL_INFO_LOG_LENGTH, &n);
  std::string log(n > 0 ? n : 1, ' ');
  text(id, static_cast<GLsizei>(log.size()), nullptr, log.data());
  while (!log.empty() && (log.back() == '\0' || log.back() == '\n')) log.pop_back();
  return log;
}

// ":LINE" out of a log such as "0:12(7): error: ...", as Mesa writes it; else nothing.
std::string lineOf(const std::string& log) {
  const std::size_t colon = log.find(':'), open = log.find('(', colon);
  if (colon == std::string::npos || open == std::string::npos) return "";
  const std::string line = log.substr(colon, open - colon);
  return line.find_first_not_of("0123456789", 1) == std::string::npos ? line : "";
}

Result<GLuint> compile(const std::filesystem::path& file, GLenum stage,
                       const std::string& define = "") {
  auto source = readFile(file);
  if (!source) return std::unexpected(source.error());
  const std::size_t version = source->find("#version");
  if (const std::size_t end = source->find('\n', version);
      !define.empty() && version != std::string::npos && end != std::string::npos) {
    const auto line =
        2 + std::count(source->begin(), source->begin() + static_cast<std::ptrdiff_t>(end), '\n');
    source->insert(end + 1, fmt::format("#define {}\n#line {}\n", define, line));
  }
  const GLuint id = glCreateShader(stage);
  const char* text = source->c_str();
  glShaderSource(id, 1, &text, nullptr);
  glCompileShader(id);
  GLint ok = 0;
  glGetShaderiv(id, GL_COMPILE_STATUS, &ok);
  if (ok) return id;
  const std::string log = infoLog(id, glGetShaderiv, glGetShaderInfoLog);
  glDeleteShader(id);
  return usageError(file.string() + lineOf(log), "the shader does not compile: " + log,
                    "Mend the line named, or restore the file.");
}
}  // namespace

Result<Program> Program::load(const std::filesystem::path& dir, const std::string& vertex,
                              const std::string& fragment, const std::string& define) {
  const auto v = compile(dir / vertex, GL_VERTEX_SHADER);
  if (!v) return std::unexpected(v.error());
  const auto f = compile(dir / fragment, GL_FRAGMENT_SHADER, define);
  if (!f) {
    glDeleteShader(*v);
    return std::unexpected(f.error());
  }
  Program p;
  p.id_ = glCreateProgram();
  glAttachShader(p.id_, *v);
  glAttachShader(p.id_, *f);
  glLinkProgram(p.id_);
  glDeleteShader(*v);
  glDeleteShader(*f);
  GLint ok = 0;
  glGetProgramiv(p.id_, GL_LINK_STATUS, &ok);
  if (!ok)
    return usageError(
        (dir / vertex).string() + " + " + fragment,
        "the stages do not link: " + infoLog(p.id_, glGetProgramiv, glGetProgramInfoLog),
        "Make outputs of the first agree with inputs of the second.");
  return p;
}

Program::~Program() {
  if (id_) glDeleteProgram(id_);
}

int Program::at(const char* name) {
  if (auto it = locations_.find(name); it != locations_.end()) return it->second;
  return locations_[name] = glGetUniformLocation(id_, name);
}

void Texture::create(GLenum format, int width, int height, GLenum filter) {
  reset();
  glGenTextures(1, &id_);
  glBindTexture(GL_TEXTURE_2D, id_);
  glTexStorage2D(GL_TEXTURE_2D, 1, format, width, height);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(filter));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

void Texture::bind(int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, id_);
}

Target::~Target() {
  if (id_) glDeleteFramebuffers(1, &id_);
}

Result<void> Target::create(const char* what, int width, int height, GLenum colourFormat,
                            GLenum depthFormat) {
  width_ = width;
  height_ = height;
  glGenFramebuffers(1, &id_);
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  if (colourFormat) {
    colour_.create(colourFormat, width, height, GL_LINEAR);
    glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, colour_.id(), 0);
  } else {
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
  }
  if (depthFormat) {
    depth_.create(depthFormat, width, height, GL_NEAREST);
    const bool stencil = depthFormat == GL_DEPTH24_STENCIL8 || depthFormat == GL_DEPTH32F_STENCIL8;
    glFramebufferTexture(GL_FRAMEBUFFER,
                         stencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT, depth_.id(),
                         0);
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return failure(what, fmt::format("no framebuffer of {} x {}", width, height),
                   "Choose a smaller size in the preset.");
  return {};
}

void Target::copyDepth(const Target& other) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, other.id_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, id_);
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
}

void Target::testAgainst(const Target& other) {
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, other.depth_.id(), 0);
}

void Target::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glViewport(0, 0, width_, height_);
}
}  // namespace swallowclip::render
