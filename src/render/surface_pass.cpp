// SPDX-License-Identifier: MIT
#include "render/surface_pass.h"

#include <algorithm>
#include <cmath>

#include "render/colour_vision.h"

namespace swallowclip::render {
namespace {

constexpr float kAoRange = 0.4f;          // depths this share of the radius apart are not mixed
constexpr float kShadowBias_m = 0.8e-3f;  // about 3 texels of a 1024 map over 250 mm

void setClips(Program& p, const std::vector<CutPlane>& cuts, int without = -1) {
  static constexpr const char* kNames[] = {"uClip[0]", "uClip[1]", "uClip[2]"};
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector4f clip(0, 0, 0, 1);
    if (i < static_cast<int>(cuts.size()) && i != without)
      clip = {-cuts[i].normal.x(), -cuts[i].normal.y(), -cuts[i].normal.z(), cuts[i].offset};
    p.set(kNames[i], clip);
  }
}

void cullBack(bool on) {
  on ? glEnable(GL_CULL_FACE) : glDisable(GL_CULL_FACE);
}

bool samePlane(const CutPlane& a, const CutPlane& b) {
  return a.normal == b.normal && a.offset == b.offset;
}

// Limits drawing to the picture of a box; all of it when the box reaches behind the eye.
void scissorTo(const Bounds& b, const Camera& camera, int width, int height) {
  Eigen::Vector2f low(1, 1), high(-1, -1);
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector4f q = camera.viewProjection * b.corner(i).homogeneous();
    if (q.w() <= 0) {
      glScissor(0, 0, width, height);
      return;
    }
    low = low.cwiseMin(q.head<2>() / q.w());
    high = high.cwiseMax(q.head<2>() / q.w());
  }
  const auto pixel = [](float v, int n, int extra) {
    return std::clamp(
        static_cast<int>(std::floor((v * 0.5f + 0.5f) * static_cast<float>(n))) + extra, 0, n);
  };
  const int x0 = pixel(low.x(), width, -1), x1 = pixel(high.x(), width, 2);
  const int y0 = pixel(low.y(), height, -1), y1 = pixel(high.y(), height, 2);
  glScissor(x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0));
}
}  // namespace

SurfacePass::~SurfacePass() {
  if (emptyArray_) glDeleteVertexArrays(1, &emptyArray_);
}

Result<void> SurfacePass::create(const std::filesystem::path& dir, const RenderPreset& preset) {
  const struct {
    Program& program;
    const char *vertex, *fragment;
  } programs[] = {{solid_, "solid.vert", "solid.frag"},
                  {depthOnly_, "solid.vert", "depth.frag"},
                  {ao_, "screen.vert", "ao.frag"},
                  {blur_, "screen.vert", "blur.frag"},
                  {composite_, "screen.vert", "composite.frag"}};
  for (const auto& p : programs) {
    auto loaded = Program::load(dir, p.vertex, p.fragment);
    if (!loaded) return std::unexpected(loaded.error());
    p.program = std::move(*loaded);
  }
  const int w = preset.width, h = preset.height, map = preset.light.shadowMap_px;
  const Result<void> made[] = {
      scene_.create("scene", w, h, preset.msaa, GL_RGBA8, GL_DEPTH24_STENCIL8),
      resolved_.create("resolved", w, h, 1, GL_RGBA8, GL_DEPTH24_STENCIL8),
      shadow_.create("shadow map", map, map, 1, 0, GL_DEPTH_COMPONENT32F),
      aoRaw_.create("occlusion", w / 2, h / 2, 1, GL_RG32F, 0),
      aoSmooth_.create("occlusion, smooth", w / 2, h / 2, 1, GL_RG32F, 0),
      picture_.create("picture", w, h, 1, GL_RGBA8, 0)};
  for (const auto& m : made)
    if (!m) return m;
  // the shadow map is compared, not read; beyond its border all is lit
  shadow_.depth().bind(0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  setSpiral(preset.ao.taps);
  mesh_.create();
  glGenVertexArrays(1, &emptyArray_);
  return {};
}

// One square per distinct cut plane, shared by all structures: equal planes give equal depths,
// so where two sections overlap the one drawn first stays.
void SurfacePass::addQuads(DrawList& list) {
  quads_.clear();
  const Vec3f centre = 0.5f * (list.bounds.low + list.bounds.high);
  const float size = (list.bounds.high - list.bounds.low).norm();
  for (const auto* items : {&list.solid, &list.ghost})
    for (const DrawItem& item : *items)
      for (const CutPlane& c : item.cuts) {
        if (quadFor(c).count) continue;
        const Vec3f foot = centre + (c.offset - c.normal.dot(centre)) * c.normal;
        const Vec3f u = c.normal.unitOrthogonal() * size, v = c.normal.cross(u);
        const Range r{static_cast<int>(list.indices.size()), 6,
                      static_cast<int>(list.vertices.size())};
        for (const Vec3f& p :
             {Vec3f(foot - u - v), Vec3f(foot + u - v), Vec3f(foot + u + v), Vec3f(foot - u + v)})
          list.vertices.push_back({p, c.normal, p});
        for (std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) list.indices.push_back(i);
        quads_.push_back({c, r});
      }
}

Range SurfacePass::quadFor(const CutPlane& plane) const {
  for (const auto& [p, range] : quads_)
    if (samePlane(p, plane)) return range;
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
    mesh_.draw(item.mesh);
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void SurfacePass::setLights(const Camera& camera, const RenderPreset& preset) {
  const LightDef& l = preset.light;
  solid_.use();
  solid_.set("uViewProj", camera.viewProjection);
  solid_.set("uEye", camera.eye);
  solid_.set("uUp", camera.up);
  solid_.set("uKeyDir", camera.fromPicture(l.key.direction));
  solid_.set("uKey", Vec3f(linear(l.key.colour_srgb) * l.key.intensity));
  solid_.set("uFillDir", camera.fromPicture(l.fill.direction));
  solid_.set("uFill", Vec3f(linear(l.fill.colour_srgb) * l.fill.intensity));
  solid_.set("uAmbientTop", Vec3f(linear(l.ambientTop_srgb) * l.ambientIntensity));
  solid_.set("uAmbientBottom", Vec3f(linear(l.ambientBottom_srgb) * l.ambientIntensity));
  solid_.set("uShadowProj", shadowFromWorld_);
  solid_.set("uShadowStrength", l.shadow ? l.shadowStrength : 0.0f);
  solid_.set("uShadowRadius", l.shadowSoftness_m / (2 * shadowRadius_m_));
  solid_.set("uShadowBias", kShadowBias_m);
  solid_.set("uUnlit", 0);
  solid_.set("uExposure", id_ > 0 ? 1.0f : preset.exposure);
  solid_.set("uToneMap", preset.toneMap && id_ == 0 ? 1 : 0);
  shadow_.depth().bind(0);
}

void SurfacePass::setMaterial(const Material& m, bool section, float opacity) {
  if (id_ > 0) {  // the shader writes the square root of an unlit colour
    const float level = static_cast<float>(id_) / 255.0f;
    solid_.set("uUnlit", 1);
    solid_.set("uBase", Vec3f(Vec3f::Constant(level * level)));
    solid_.set("uOpacity", 1.0f);
    return;
  }
  solid_.set("uBase", linear(section ? m.sectionColour_srgb : m.baseColour_srgb));
  solid_.set("uSpecular", m.specular);
  solid_.set("uRoughness", std::clamp(m.roughness, 0.05f, 1.0f));
  solid_.set("uTranslucency", section ? 0.0f : m.translucency);
  solid_.set("uWetness", section ? 0.0f : m.wetness);
  solid_.set("uMottle", section ? 0.3f * m.mottle : m.mottle);
  solid_.set("uRelief", section ? 0.0f : m.relief);
  solid_.set("uReliefSize", m.reliefSize_m);
  solid_.set("uSection", section ? 1 : 0);
  solid_.set("uOpacity", opacity);
}

// Stencil, then cover: the fan's winding number is not 0 exactly inside the section, however
// concave or holed it is.
void SurfacePass::drawCaps(const DrawItem& item, const Camera& camera) {
  for (int k = 0; k < static_cast<int>(item.cuts.size()); ++k) {
    const CutPlane& c = item.cuts[k];
    if (item.fans[k].count == 0 || !camera.sees(c.normal, c.offset)) continue;
    glEnable(GL_SCISSOR_TEST);
    scissorTo(item.fanBounds[static_cast<std::size_t>(k)], camera, scene_.width(), scene_.height());
    // the cover below leaves the stencil empty again, but where another cut takes from it
    if (item.cuts.size() > 1) glClear(GL_STENCIL_BUFFER_BIT);
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_ALWAYS, 0, 0xff);
    glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_DECR_WRAP, GL_DECR_WRAP);
    glStencilOpSeparate(GL_BACK, GL_KEEP, GL_INCR_WRAP, GL_INCR_WRAP);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDisable(GL_DEPTH_TEST);
    depthOnly_.use();
    depthOnly_.set("uViewProj", camera.viewProjection);
    setClips(depthOnly_, {});
    mesh_.draw(item.fans[k]);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glStencilFunc(GL_NOTEQUAL, 0, 0xff);
    glStencilOp(GL_KEEP, GL_ZERO, GL_ZERO);
    solid_.use();
    setMaterial(*item.material, true, 1.0f);
    setClips(solid_, item.cuts, k);
    mesh_.draw(quadFor(c));
    if (item.cuts.size() > 1) glClear(GL_STENCIL_BUFFER_BIT);
    glDisable(GL_STENCIL_TEST);
    glDisable(GL_SCISSOR_TEST);
  }
}

void SurfacePass::drawOutlines(const DrawItem& item, const Camera& camera,
                               const RenderPreset& preset) {
  for (int k = 0; k < static_cast<int>(item.outlines.size()); ++k) {
    if (item.outlines[k].count == 0 || !camera.sees(item.cuts[k].normal, item.cuts[k].offset))
      continue;
    const float keep = 1 - preset.sectionOutlineDarkness;
    solid_.set("uUnlit", 1);
    solid_.set("uOpacity", std::sqrt(item.opacity));
    solid_.set("uBase", Vec3f(linear(item.material->sectionColour_srgb) * keep * keep));
    setClips(solid_, item.cuts, k);
    mesh_.draw(item.outlines[k]);
    solid_.set("uUnlit", 0);
  }
}

void SurfacePass::drawSolids(const Target& to, const DrawList& list, const Camera& camera,
                             const RenderPreset& preset) {
  to.bind();
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  glDepthFunc(GL_LESS);
  setLights(camera, preset);
  const bool ids = id_ > 0;
  // caps in order of priority; then the nearest meshes first, so that what they hide is not shaded
  for (const DrawItem& item : list.solid) {
    drawCaps(item, camera);
    if (ids) ++id_;
  }
  id_ = ids ? 1 : 0;
  for (const int index : nearestFirst(list.solid, camera.back)) {
    const DrawItem& item = list.solid[static_cast<std::size_t>(index)];
    if (ids) id_ = 1 + index;
    setMaterial(*item.material, false, 1.0f);
    setClips(solid_, item.cuts);
    cullBack(item.closed);  // caps hide every back face of a closed mesh
    mesh_.draw(item.mesh);
    cullBack(false);
  }
  if (ids) id_ = 1 + static_cast<int>(list.solid.size());
  if (!ids)
    for (const DrawItem& item : list.solid) drawOutlines(item, camera, preset);
}

// Depth first, so that only the nearest layer of a ghost is seen.
void SurfacePass::drawGhosts(const DrawList& list, const Camera& camera,
                             const RenderPreset& preset) {
  if (list.ghost.empty()) return;
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthFunc(GL_LEQUAL);
  for (const DrawItem& item : list.ghost) {
    depthOnly_.use();
    depthOnly_.set("uViewProj", camera.viewProjection);
    setClips(depthOnly_, item.cuts);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    mesh_.draw(item.mesh);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    solid_.use();
    setMaterial(*item.material, false, item.opacity);
    setClips(solid_, item.cuts);
    mesh_.draw(item.mesh);
    drawOutlines(item, camera, preset);
  }
  glDisable(GL_BLEND);
}

void SurfacePass::drawOcclusion(const Camera& camera, const RenderPreset& preset) {
  const int w = preset.width, h = preset.height;
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(emptyArray_);
  aoRaw_.bind();
  ao_.use();
  ao_.set("uNearFar", Vec3f(camera.near_m, camera.far_m, camera.eye.w()));
  ao_.set("uTanHalf", Eigen::Vector2f(1 / camera.projection(0, 0), 1 / camera.projection(1, 1)));
  ao_.set("uSize", Eigen::Vector2f(static_cast<float>(w), static_cast<float>(h)));
  ao_.set("uPixelsPerMetre", camera.pixelsPerMetre);
  ao_.set("uRadius", preset.ao.radius_m);
  ao_.set("uTaps", preset.ao.taps);
  resolved_.depth().bind(0);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  aoSmooth_.bind();
  blur_.use();
  blur_.set("uRange", kAoRange * preset.ao.radius_m);
  aoRaw_.colour().bind(0);
  glDrawArrays(GL_TRIANGLES, 0, 3);
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

void SurfacePass::composite(const Camera& camera, const RenderPreset& preset) {
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(emptyArray_);
  picture_.bind();
  composite_.use();
  composite_.set("uAoStrength", preset.ao.strength);
  composite_.set("uNearFar", Vec3f(camera.near_m, camera.far_m, camera.eye.w()));
  composite_.set("uRange", kAoRange * preset.ao.radius_m);
  composite_.set("uTop", preset.background.top_srgb);
  composite_.set("uBottom", preset.background.bottom_srgb);
  resolved_.colour().bind(0);
  aoSmooth_.colour().bind(1);
  resolved_.depth().bind(2);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void SurfacePass::begin(DrawList& list) {
  for (int i = 0; i < 3; ++i) glEnable(GL_CLIP_DISTANCE0 + static_cast<GLenum>(i));
  glDisable(GL_CULL_FACE);
  glEnable(GL_MULTISAMPLE);
  glEnable(GL_DEPTH_TEST);
  addQuads(list);
  mesh_.upload(list.vertices, list.indices);
}

void SurfacePass::end() {
  for (int i = 0; i < 3; ++i) glDisable(GL_CLIP_DISTANCE0 + static_cast<GLenum>(i));
}

Result<Image> SurfacePass::draw(DrawList& list, const Camera& camera, const RenderPreset& preset) {
  begin(list);
  drawShadowMap(list, camera, preset);
  drawSolids(scene_, list, camera, preset);
  scene_.resolveTo(resolved_, GL_DEPTH_BUFFER_BIT);
  scene_.bind();
  drawGhosts(list, camera, preset);
  scene_.resolveTo(resolved_, GL_COLOR_BUFFER_BIT);
  end();
  if (preset.ao.strength > 0) drawOcclusion(camera, preset);
  composite(camera, preset);
  picture_.bind();
  Image image = readPicture(preset.width, preset.height);
  if (auto ok = checkedGl("surfaces"); !ok) return std::unexpected(ok.error());
  return image;
}

void SurfacePass::countIds(const std::vector<DrawItem>& items, int firstId,
                           const RenderPreset& preset, std::map<std::string, int>& counts) {
  const Image ids = readPicture(preset.width, preset.height);
  for (std::size_t i = 0; i < ids.rgba.size(); i += 4)
    if (const int k = ids.rgba[i] - firstId; k >= 0 && k < static_cast<int>(items.size()))
      ++counts[items[static_cast<std::size_t>(k)].name];
}

Result<std::map<std::string, int>> SurfacePass::visiblePixels(DrawList& list, const Camera& camera,
                                                              const RenderPreset& preset) {
  constexpr std::size_t kMostIds = 255;  // of 8 bits, 0 is the background
  if (list.solid.size() + list.ghost.size() > kMostIds)
    return failure("visible pixels", fmt::format("more than {} structures", kMostIds),
                   "Hide some in the view.");
  begin(list);
  id_ = 1;
  drawSolids(resolved_, list, camera, preset);
  std::map<std::string, int> counts;
  countIds(list.solid, 1, preset, counts);
  const int firstGhost = id_;
  for (const DrawItem& item : list.ghost) {
    setMaterial(*item.material, false, 1.0f);
    setClips(solid_, item.cuts);
    mesh_.draw(item.mesh);
    ++id_;
  }
  countIds(list.ghost, firstGhost, preset, counts);
  id_ = 0;
  end();
  if (auto ok = checkedGl("surfaces"); !ok) return std::unexpected(ok.error());
  return counts;
}
}  // namespace swallowclip::render
