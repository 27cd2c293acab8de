// SPDX-License-Identifier: MIT
#include "render/context.h"

#include <GL/osmesa.h>

#include <array>

#include "render/gl.h"

namespace swallowclip::render {
namespace {

class OsmesaContext final : public Context {
 public:
  explicit OsmesaContext(OSMesaContext c) : context_(c) {}
  ~OsmesaContext() override { OSMesaDestroyContext(context_); }

  Result<void> makeCurrent() override {
    // The default framebuffer is never drawn to: 4 x 4 is enough to be current.
    if (!OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, 4, 4))
      return failure("OSMesa", "the off-screen context cannot be made current",
                     "Check the packages libosmesa6 and libgl1-mesa-dri.");
    return {};
  }
  std::string description() const override {
    const auto text = [](GLenum what) {
      const auto* s = reinterpret_cast<const char*>(glGetString(what));
      return std::string(s ? s : "?");
    };
    return text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
  }

 private:
  OSMesaContext context_;
  std::array<unsigned char, 4 * 4 * 4> pixels_{};
};
}  // namespace

Result<std::unique_ptr<Context>> createOsmesaContext() {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            0,
                            OSMESA_STENCIL_BITS,
                            0,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            4,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            5,
                            0};
  OSMesaContext raw = OSMesaCreateContextAttribs(attributes, nullptr);
  if (!raw)
    return failure("OSMesa", "no OpenGL 4.5 core context off screen",
                   "Install libosmesa6 of Mesa 20..25.0 with llvmpipe (Debian: libgl1-mesa-dri).");
  auto context = std::make_unique<OsmesaContext>(raw);
  if (auto ok = context->makeCurrent(); !ok) return std::unexpected(ok.error());
  return context;
}
}  // namespace swallowclip::render
