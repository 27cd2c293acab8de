// SPDX-License-Identifier: MIT
#include "render/plain_pass.h"

namespace swallowclip::render {

Result<void> PlainPass::create(const std::filesystem::path& dir, const RenderPreset& preset) {
  auto loaded = Program::load(dir, "solid.vert", "plain.frag");
  if (!loaded) return std::unexpected(loaded.error());
  program_ = std::move(*loaded);
  return picture_.create("plain picture", preset.width, preset.height, GL_RGBA8,
                         GL_DEPTH_COMPONENT32F);
}

Result<Image> PlainPass::draw(const GpuMesh& mesh, const DrawList& list, const Camera& camera) {
  picture_.bind();
  glClearColor(0, 0, 0, 1);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  program_.use();
  for (const char* clip : {"uClip[0]", "uClip[1]", "uClip[2]"})
    program_.set(clip, Eigen::Vector4f(0, 0, 0, 1));
  program_.set("uViewProj", camera.viewProjection);
  program_.set("uEye", camera.eye);
  for (const auto* items : {&list.solid, &list.ghost})
    for (const DrawItem& item : *items) mesh.draw(item);
  Image image = readPicture(picture_.width(), picture_.height());
  if (auto ok = checkedGl("plainly"); !ok) return std::unexpected(ok.error());
  return image;
}
}  // namespace swallowclip::render
