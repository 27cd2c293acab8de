// SPDX-License-Identifier: MIT
#include "render/fluoro_pass.h"

namespace swallowclip::render {

FluoroPass::~FluoroPass() {
  if (emptyArray_) glDeleteVertexArrays(1, &emptyArray_);
}

Result<void> FluoroPass::create(const std::filesystem::path& dir, const RenderPreset& preset) {
  auto length = Program::load(dir, "solid.vert", "fluoro_length.frag");
  if (!length) return std::unexpected(length.error());
  length_ = std::move(*length);
  auto display = Program::load(dir, "screen.vert", "fluoro.frag");
  if (!display) return std::unexpected(display.error());
  display_ = std::move(*display);
  const int w = preset.width, h = preset.height;
  if (auto ok = depth_.create("fluoroscopy", w, h, 1, GL_R32F, 0); !ok) return ok;
  if (auto ok = picture_.create("fluoroscopy picture", w, h, 1, GL_RGBA8, 0); !ok) return ok;
  mesh_.create();
  glGenVertexArrays(1, &emptyArray_);
  return {};
}

Result<Image> FluoroPass::draw(const DrawList& list, const Camera& camera,
                               const RenderPreset& preset, int frame) {
  const FluoroDef& def = preset.fluoro;
  mesh_.upload(list.vertices, list.indices);
  depth_.bind();
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  length_.use();
  length_.set("uViewProj", camera.viewProjection);
  length_.set("uEye", camera.eye);
  for (const auto* items : {&list.solid, &list.ghost})
    for (const DrawItem& item : *items) {
      // tissue counts against the air of the airway, denser bodies against the tissue around them
      const float mu = item.material->attenuation_per_m;
      length_.set("uAttenuation",
                  mu > 1.15f * def.softTissue_per_m ? mu - def.softTissue_per_m : 0.5f * mu);
      mesh_.draw(item.mesh);
    }
  glDisable(GL_BLEND);
  picture_.bind();
  glBindVertexArray(emptyArray_);
  display_.use();
  display_.set("uTissue", def.softTissue_per_m * def.bodyThickness_m);
  display_.set("uExposure", def.exposure);
  display_.set("uNoise", def.noise);
  display_.set("uBlur", def.blur_px * static_cast<float>(preset.height) / 720.0f);
  display_.set("uDark", def.boneDark ? 1 : 0);
  display_.set("uFrame", frame);
  depth_.colour().bind(0);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  Image image = readPicture(preset.width, preset.height);
  if (const GLenum e = glGetError(); e != GL_NO_ERROR)
    return failure("OpenGL", fmt::format("error 0x{:04x} while drawing fluoroscopy", e),
                   "Report it with the preset and the driver's version.");
  return image;
}
}  // namespace swallowclip::render
