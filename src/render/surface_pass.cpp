// SPDX-License-Identifier: MIT
#include "render/surface_pass.h"

#include <algorithm>
#include <cmath>

#include "render/background.h"
#include "render/colour_vision.h"
#include "render/edges.h"

namespace swallowclip::render {
namespace {
constexpr int kAoShare = 4;               // occlusion is smooth: one value for 4 x 4 pixels
constexpr float kAoRange = 0.4f;          // depths this share of the radius apart are not mixed
constexpr float kShadowBias_m = 0.8e-3f;  // about 3 texels of a 1024 map over 250 mm
constexpr std::size_t kMostIds = 255;     // of 8 bits, 0 is the background

void setClips(Program& p, const std::vector<CutPlane>& cuts, int without = -1) {
  static constexpr const char* kNames[] = {"uClip[0]", "uClip[1]", "uClip[2]"};
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector4f clip(0, 0, 0, 1);
    if (i < static_cast<int>(cuts.size()) && i != without)
      clip = {-cuts[i].normal.x(), -cuts[i].normal.y(), -cuts[i].normal.z(), cuts[i].offset};
    p.set(kNames[i], clip);
  }
}

void clipping(bool on) {
  for (GLenum i = 0; i < 3; ++i)
    on ? glEnable(GL_CLIP_DISTANCE0 + i) : glDisable(GL_CLIP_DISTANCE0 + i);
}

void cullBack(bool on) {
  on ? glEnable(GL_CULL_FACE) : glDisable(GL_CULL_FACE);
}

float idLevel(std::size_t index) {
  return static_cast<float>(index + 1) / 255.0f;
}

int shareOf(int pixels) {
  return (pixels + kAoShare - 1) / kAoShare;
}

}  // namespace

Result<void> SurfacePass::create(const std::filesystem::path& dir, const RenderPreset& preset) {
  const struct {
    Program& program;
    const char *vertex, *fragment, *define;
  } programs[] = {{smooth_, "solid.vert", "solid.frag", ""},
                  {detailed_, "solid.vert", "solid.frag", "DETAIL"},
                  {section_, "solid.vert", "section.frag", ""},
                  {flat_, "solid.vert", "flat.frag", ""},
                  {depthOnly_, "solid.vert", "depth.frag", ""},
                  {ao_, "screen.vert", "ao.frag", ""},
                  {blur_, "screen.vert", "blur.frag", ""},
                  {composite_, "screen.vert", "composite.frag", ""}};
  for (const auto& p : programs) {
    auto loaded = Program::load(dir, p.vertex, p.fragment, p.define);
    if (!loaded) return std::unexpected(loaded.error());
    p.program = std::move(*loaded);
  }
  const int w = preset.width, h = preset.height, map = preset.light.shadowMap_px;
  const Result<void> made[] = {
      scene_.create("scene", w, h, GL_RGBA8, GL_DEPTH24_STENCIL8),
      shadow_.create("shadow map", map, map, 0, GL_DEPTH_COMPONENT32F),
      aoRaw_.create("occlusion", shareOf(w), shareOf(h), GL_RG32F, 0),
      aoSmooth_.create("occlusion, smooth", shareOf(w), shareOf(h), GL_RG32F, 0),
      picture_.create("picture", w, h, GL_RGBA8, 0),
      ghosts_.create(dir, w, h)};
  for (const auto& m : made)
    if (!m) return m;
  picture_.testAgainst(scene_);
  // the shadow map is compared, not read; beyond its border all is lit
  shadow_.depth().bind(0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  setSpiral(preset.ao.taps);
  background_ = makeBackground(preset);
  encoding_ = makeEncoding();
  return {};
}

void SurfacePass::drawShadowMap(const DrawList& list, const Camera& camera,
                                const RenderPreset& preset) {
  shadowFromWorld_ = shadowMatrix(list.restBounds, camera.fromPicture(preset.light.key.direction),
                                  &shadowRadius_m_);
  if (!preset.light.shadow) return;
  Mat4f clipFromTexture = Mat4f::Identity();
  clipFromTexture.diagonal() << 2, 2, 2, 1;
  clipFromTexture.block<3, 1>(0, 3).setConstant(-1);
  shadow_.bind();
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(2.0f, 4.0f);
  depthOnly_.use();
  depthOnly_.set("uViewProj", Mat4f(clipFromTexture * shadowFromWorld_));
  for (const DrawItem& item : list.solid) {
    setClips(depthOnly_, item.cuts);
    cullBack(item.closed && item.cuts.empty());
    mesh_->draw(item);
  }
  cullBack(false);
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void SurfacePass::setView(const Camera& camera, const RenderPreset& preset) {
  const LightDef& l = preset.light;
  for (Program* p : {&smooth_, &detailed_, &section_, &flat_, &depthOnly_}) {
    p->use();
    p->set("uViewProj", camera.viewProjection);
    p->set("uEye", camera.eye);
    p->set("uUp", camera.up);
    p->set("uKeyDir", camera.fromPicture(l.key.direction));
    p->set("uKey", Vec3f(linear(l.key.colour_srgb) * l.key.intensity));
    p->set("uFillDir", camera.fromPicture(l.fill.direction));
    p->set("uFill", Vec3f(linear(l.fill.colour_srgb) * l.fill.intensity));
    p->set("uAmbientTop", Vec3f(linear(l.ambientTop_srgb) * l.ambientIntensity));
    p->set("uAmbientBottom", Vec3f(linear(l.ambientBottom_srgb) * l.ambientIntensity));
    p->set("uShadowProj", shadowFromWorld_);
    p->set("uShadowStrength", l.shadow ? l.shadowStrength : 0.0f);
    p->set("uShadowRadius", l.shadowSoftness_m / (2 * shadowRadius_m_));
    p->set("uShadowBias", kShadowBias_m);
    p->set("uExposure", preset.exposure);
    p->set("uToneMap", preset.toneMap ? 1 : 0);
  }
  shadow_.depth().bind(0);
}

Program& SurfacePass::surfaceOf(const DrawItem& item, float id, float opacity) {
  const Material& m = *item.material;
  Program& p = onlyIds_ ? flat_ : m.mottle > 0 || m.relief > 0 ? detailed_ : smooth_;
  p.use();
  p.set("uBase", linear(m.baseColour_srgb));
  p.set("uSpecular", m.specular);
  p.set("uRoughness", std::clamp(m.roughness, 0.05f, 1.0f));
  p.set("uTranslucency", m.translucency);
  p.set("uWetness", m.wetness);
  p.set("uMottle", m.mottle);
  p.set("uRelief", m.relief);
  p.set("uReliefSize", m.reliefSize_m);
  p.set("uOpacity", opacity);
  p.set("uId", id);
  setClips(p, item.cuts);
  return p;
}

// Stencil, then cover: the fan's winding number is not 0 exactly inside the section, however
// concave or holed it is.
void SurfacePass::drawCaps(const DrawItem& item, const Camera& camera, float id) {
  for (int k = 0; k < static_cast<int>(item.cuts.size()); ++k) {
    const CutPlane& c = item.cuts[k];
    const Section& section = item.sections[k];
    if (section.fan.count == 0 || !camera.sees(c.normal, c.offset)) continue;
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_ALWAYS, 0, 0xff);
    glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_DECR_WRAP, GL_DECR_WRAP);
    glStencilOpSeparate(GL_BACK, GL_KEEP, GL_INCR_WRAP, GL_INCR_WRAP);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDisable(GL_DEPTH_TEST);
    depthOnly_.use();
    setClips(depthOnly_, {});
    mesh_->draw(section.fan);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glStencilFunc(GL_NOTEQUAL, 0, 0xff);
    glStencilOp(GL_KEEP, GL_ZERO, GL_ZERO);
    Program& p = onlyIds_ ? flat_ : section_;
    p.use();
    p.set("uBase", linear(item.material->sectionColour_srgb));
    p.set("uId", id);
    setClips(p, item.cuts, k);
    mesh_->draw(section.cover);
    // the cover leaves the stencil empty again, but where another cut takes from it
    if (item.cuts.size() > 1) glClear(GL_STENCIL_BUFFER_BIT);
    glDisable(GL_STENCIL_TEST);
  }
}

void SurfacePass::drawOutlines(const DrawItem& item, const Camera& camera,
                               const RenderPreset& preset, float alpha) {
  for (int k = 0; k < static_cast<int>(item.sections.size()); ++k) {
    if (item.sections[k].outline.count == 0 ||
        !camera.sees(item.cuts[k].normal, item.cuts[k].offset))
      continue;
    const float keep = 1 - preset.sectionOutlineDarkness;
    flat_.use();
    flat_.set("uBase", Vec3f(linear(item.material->sectionColour_srgb) * keep * keep));
    flat_.set("uId", alpha);
    setClips(flat_, item.cuts, k);
    mesh_->draw(item.sections[k].outline);
  }
}

void SurfacePass::drawSolids(const DrawList& list, const Camera& camera,
                             const RenderPreset& preset) {
  scene_.bind();
  // ghosts over the background are mixed with this instead of its exact shade
  const Colour sky = 0.5f * (preset.background.top_srgb + preset.background.bottom_srgb);
  const Vec3f clear = linear(sky).cwiseSqrt();
  glClearColor(clear.x(), clear.y(), clear.z(), 0);
  glEnable(GL_DEPTH_TEST);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  glDepthFunc(GL_LESS);
  setView(camera, preset);
  for (std::size_t i = 0; i < list.solid.size(); ++i) {
    drawCaps(list.solid[i], camera, idLevel(i));
    if (!onlyIds_) drawOutlines(list.solid[i], camera, preset, idLevel(i));
  }
  // the nearest meshes first, so that what they hide is not shaded
  for (const int index : nearestFirst(list.solid, camera.back)) {
    const DrawItem& item = list.solid[static_cast<std::size_t>(index)];
    surfaceOf(item, idLevel(static_cast<std::size_t>(index)), 1.0f);
    cullBack(item.closed);  // caps hide every back face of a closed mesh
    mesh_->draw(item);
  }
  cullBack(false);
}

void SurfacePass::drawGhost(const DrawItem& item, const Camera& camera,
                            const RenderPreset& preset) {
  surfaceOf(item, 1.0f, item.opacity);
  mesh_->draw(item);
  drawOutlines(item, camera, preset, std::sqrt(item.opacity));
}

// Of each ghost only the nearest surface is seen, and the number of the nearest one kept.
Result<void> SurfacePass::drawGhosts(const DrawList& list, const Camera& camera,
                                     const RenderPreset& preset) {
  const std::size_t count = list.ghost.size();
  glDepthFunc(GL_LEQUAL);
  for (std::size_t i = 0; count > 1 && i < count; ++i) {
    if (auto ok = ghosts_.begin(i, scene_); !ok) return ok;
    shadow_.depth().bind(0);
    drawGhost(list.ghost[i], camera, preset);
  }
  clipping(false);
  if (count > 1) ghosts_.resolve(count, scene_, *mesh_);
  clipping(true);
  scene_.bind();
  glEnable(GL_DEPTH_TEST);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
  for (std::size_t i = 0; i < count; ++i) {
    flat_.use();
    flat_.set("uId", idLevel(list.solid.size() + i));
    setClips(flat_, list.ghost[i].cuts);
    mesh_->draw(list.ghost[i]);
  }
  if (count == 1) {  // needs no layer
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
    shadow_.depth().bind(0);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_BLEND);
    drawGhost(list.ghost[0], camera, preset);
    glDisable(GL_BLEND);
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  return {};
}

void SurfacePass::drawOcclusion(const Camera& camera, const RenderPreset& preset) {
  glDisable(GL_DEPTH_TEST);
  aoRaw_.bind();
  ao_.use();
  ao_.set("uNearFar", Vec3f(camera.near_m, camera.far_m, camera.eye.w()));
  ao_.set("uTanHalf", Eigen::Vector2f(1 / camera.projection(0, 0), 1 / camera.projection(1, 1)));
  ao_.set("uSize",
          Eigen::Vector2f(static_cast<float>(preset.width), static_cast<float>(preset.height)));
  ao_.set("uShare", kAoShare);
  ao_.set("uPixelsPerMetre", camera.pixelsPerMetre);
  ao_.set("uRadius", preset.ao.radius_m);
  ao_.set("uTaps", preset.ao.taps);
  scene_.depth().bind(0);
  mesh_->drawScreen();
  aoSmooth_.bind();
  blur_.use();
  blur_.set("uRange", kAoRange * preset.ao.radius_m);
  aoRaw_.colour().bind(0);
  mesh_->drawScreen();
}

// Tap i of n at radius (i + 0.5) / n, turned by the golden angle.
void SurfacePass::setSpiral(int taps) {
  ao_.use();
  for (int i = 0; i < taps; ++i) {
    const float r = (static_cast<float>(i) + 0.5f) / static_cast<float>(taps);
    const float turn = 2.39996f * static_cast<float>(i);
    ao_.set(fmt::format("uSpiral[{}]", i).c_str(),
            Eigen::Vector2f(r * std::cos(turn), r * std::sin(turn)));
  }
}

// Only where something was drawn: the far plane lies behind it.
void SurfacePass::composite(const Camera& camera, const RenderPreset& preset) {
  picture_.bind();
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  composite_.use();
  composite_.set("uAoStrength", preset.ao.strength);
  composite_.set("uNearFar", Vec3f(camera.near_m, camera.far_m, camera.eye.w()));
  composite_.set("uShare", kAoShare);
  composite_.set("uRange", kAoRange * preset.ao.radius_m);
  scene_.colour().bind(0);
  aoSmooth_.colour().bind(1);
  scene_.depth().bind(2);
  mesh_->drawScreen();
  glDepthMask(GL_TRUE);
}

// sRGB, before the background, opaque.
void SurfacePass::finish(Image& image, bool smooth) const {
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    std::uint8_t* p = &image.rgba[i];
    if (p[3] == 0)
      std::copy_n(&background_.rgba[i], 3, p);
    else
      for (int k = 0; k < 3; ++k) p[k] = encoding_[p[k]];
    if (!smooth) p[3] = 255;
  }
  if (smooth) smoothEdges(image);
}

Result<Image> SurfacePass::draw(const GpuMesh& mesh, const DrawList& list, const Camera& camera,
                                const RenderPreset& preset) {
  if (auto ok = begin(mesh, list, false); !ok) return std::unexpected(ok.error());
  drawShadowMap(list, camera, preset);
  drawSolids(list, camera, preset);
  clipping(false);
  if (preset.ao.strength > 0) drawOcclusion(camera, preset);
  clipping(true);
  if (auto ok = drawGhosts(list, camera, preset); !ok) return std::unexpected(ok.error());
  clipping(false);
  if (preset.ao.strength > 0)
    composite(camera, preset);
  else
    scene_.bind();
  Image image = readPicture(preset.width, preset.height);
  if (auto ok = checkedGl("surfaces"); !ok) return std::unexpected(ok.error());
  finish(image, preset.smoothEdges);
  return image;
}

Result<void> SurfacePass::begin(const GpuMesh& mesh, const DrawList& list, bool onlyIds) {
  if (list.solid.size() + list.ghost.size() > kMostIds)
    return failure("view", fmt::format("more than {} structures", kMostIds),
                   "Hide some in the view.");
  if (list.ghost.size() > GhostLayers::kMost)
    return failure("view", fmt::format("more than {} ghosted structures", GhostLayers::kMost),
                   "Hide some in the view.");
  mesh_ = &mesh;
  onlyIds_ = onlyIds;
  clipping(true);
  glDisable(GL_CULL_FACE);
  return {};
}

void SurfacePass::countIds(const std::vector<DrawItem>& items, std::size_t first,
                           const RenderPreset& preset, std::map<std::string, int>& counts) {
  const Image ids = readPicture(preset.width, preset.height);
  std::array<int, 256> seen{};
  for (std::size_t i = 3; i < ids.rgba.size(); i += 4) ++seen[ids.rgba[i]];
  for (std::size_t i = 0; i < items.size(); ++i) counts[items[i].name] += seen[first + i + 1];
}

Result<std::map<std::string, int>> SurfacePass::visiblePixels(const GpuMesh& mesh, DrawList list,
                                                              const Camera& camera,
                                                              const RenderPreset& preset) {
  if (auto ok = begin(mesh, list, true); !ok) return std::unexpected(ok.error());
  std::vector<DrawItem> bolus;  // comes last in the list
  if (!list.solid.empty() && list.solid.back().name == "bolus") {
    bolus.push_back(std::move(list.solid.back()));
    list.solid.pop_back();
  }
  drawSolids(list, camera, preset);
  std::map<std::string, int> counts;
  countIds(list.solid, 0, preset, counts);
  std::size_t first = list.solid.size();
  for (const auto* items : {&bolus, &list.ghost}) {
    for (std::size_t i = 0; i < items->size(); ++i) {
      surfaceOf((*items)[i], idLevel(first + i), 1.0f);
      mesh_->draw((*items)[i]);
    }
    if (!items->empty()) countIds(*items, first, preset, counts);
    first += items->size();
  }
  clipping(false);
  if (auto ok = checkedGl("surfaces"); !ok) return std::unexpected(ok.error());
  return counts;
}
}  // namespace swallowclip::render
