// SPDX-License-Identifier: MIT
#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "render/context.h"
#include "render/draw_list.h"
#include "render/fluoro_pass.h"
#include "render/plain_pass.h"
#include "render/surface_pass.h"

namespace swallowclip::render {

namespace {
const std::string kBolus = "bolus", kBolusInMouth = "bolus_in_mouth";
constexpr double kPromisedBolus_m3 = 4.968e-6;  // 621 particles of (2 mm)^3
/// One frame's geometry, shared by its views.
struct Model {
  float error_m = 0;
  Prepared prepared;
  FrameGeometry geometry;
  GpuMesh mesh;
  std::uint64_t digest = 0;  ///< of what `geometry` was made from; 0: of nothing yet

  void update(const frame::History& history, int frame, const RenderPreset& preset) {
    const std::uint64_t now = frameDigest(history, frame);
    if (now == digest) return;
    if (prepared.meshes.empty() || prepared.digest != topologyDigest(history))
      prepared = prepare(history, preset.creaseAngle_rad, error_m);
    geometry = frameGeometry(history, frame, prepared, preset);
    mesh.uploadFrame(geometry.vertices);
    digest = now;
  }
};
}  // namespace

struct Renderer::Impl {
  std::unique_ptr<Context> context;  // first: outlives everything made in it
  RenderPreset preset;
  SurfacePass surface;
  FluoroPass fluoro;
  PlainPass plain;
  Model seen, exact;  ///< rays measure lengths, so that fluoroscopy takes the meshes as they are
  int triangles = 0;
};

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() {
  if (impl_) (void)impl_->context->makeCurrent();  // GL objects are deleted in their own context
}
const RenderPreset& Renderer::preset() const {
  return impl_->preset;
}
int Renderer::trianglesDrawn() const {
  return impl_->triangles;
}
std::string Renderer::description() const {
  return impl_->context->description();
}

Result<Renderer> Renderer::create(const std::filesystem::path& shaderDir, RenderPreset preset) {
  if (auto wrong = preset.validate(); !wrong.empty())
    return usageError("render preset '" + preset.name + "'", wrong, "Mend the preset.");
  auto impl = std::make_unique<Impl>();
  auto context = createOsmesaContext();
  if (!context) return std::unexpected(context.error());
  impl->context = std::move(*context);
  impl->preset = std::move(preset);
  if (auto ok = impl->surface.create(shaderDir, impl->preset); !ok)
    return std::unexpected(ok.error());
  if (auto ok = impl->fluoro.create(shaderDir, impl->preset); !ok)
    return std::unexpected(ok.error());
  if (auto ok = impl->plain.create(shaderDir, impl->preset); !ok)
    return std::unexpected(ok.error());
  impl->seen.error_m = unseenDetail_m(impl->preset.height);
  for (Model* m : {&impl->seen, &impl->exact}) m->mesh.create();
  return Renderer(std::move(impl));
}

namespace {
// The history comes from a file: what is indexed below is checked here.
std::string unusable(const frame::History& h, int frame) {
  const auto f = static_cast<std::size_t>(frame);
  for (const frame::StructureTrack& s : h.structures) {
    if (s.rigid ? f >= s.poses.size() : f >= s.positions.size())
      return fmt::format("structure '{}' has no frame {}", s.name, frame);
    const std::size_t n = s.rigid ? s.rest.size() : s.positions[f].size();
    if (!s.rigid && n != s.positions[0].size())
      return fmt::format("structure '{}' changes its vertex count at frame {}", s.name, frame);
    for (const Triangle& t : s.triangles)
      for (int v : t)
        if (v < 0 || static_cast<std::size_t>(v) >= n)
          return fmt::format("structure '{}' names vertex {} of {}", s.name, v, n);
  }
  const auto& b = h.bolus;
  if (!b.positions.empty() &&
      (f >= b.positions.size() ||
       (!b.state.empty() && (f >= b.state.size() || b.state[f].size() != b.positions[f].size()))))
    return fmt::format("the bolus has no complete frame {}", frame);
  if (!h.skin.positions.empty() && f >= h.skin.positions.size())
    return fmt::format("the skin has no frame {}", frame);
  return "";
}
}  // namespace

// One frame as triangles and a camera, with the context current.
struct Renderer::Scene {
  const ViewDef* view;
  const GpuMesh* mesh;
  DrawList list;
  Camera camera;
};

Result<Renderer::Scene> Renderer::prepareScene(const frame::History& history, int frame,
                                               const std::string& view) {
  const RenderPreset& preset = impl_->preset;
  const auto found = preset.views.find(view);
  if (found == preset.views.end()) {
    std::vector<std::string> names;
    for (const auto& [name, def] : preset.views) names.push_back(name);
    const std::string near = nearestName(view, names);
    return usageError("view '" + view + "'", "not in the preset '" + preset.name + "'",
                      near.empty() ? fmt::format("Choose one of: {}.", fmt::join(names, ", "))
                                   : "Did you mean '" + near + "'?");
  }
  if (frame < 0 || frame >= history.frames())
    return usageError(fmt::format("frame {}", frame),
                      fmt::format("the history has frames 0..{}", history.frames() - 1),
                      "Choose one of them.");
  if (auto wrong = unusable(history, frame); !wrong.empty())
    return failure("history", wrong, "Simulate again.");
  if (auto ok = impl_->context->makeCurrent(); !ok) return std::unexpected(ok.error());
  Model& model = found->second.style == Style::fluoro ? impl_->exact : impl_->seen;
  model.update(history, frame, preset);
  Scene s{&found->second,
          &model.mesh,
          buildDrawList(history, frame, model.geometry, preset, found->second),
          {}};
  model.mesh.uploadView(s.list);
  impl_->triangles = static_cast<int>(s.list.indices.size() + s.list.extra.size()) / 3;
  s.camera = makeCamera(found->second, preset.width, preset.height, s.list.bounds);
  return s;
}

Result<Image> Renderer::draw(const frame::History& history, int frame, const std::string& view,
                             const CaptionText& caption) {
  auto scene = prepareScene(history, frame, view);
  if (!scene) return std::unexpected(scene.error());
  const RenderPreset& preset = impl_->preset;
  auto image = scene->view->style == Style::fluoro
                   ? impl_->fluoro.draw(*scene->mesh, scene->list, scene->camera, preset, frame)
                   : impl_->surface.draw(*scene->mesh, scene->list, scene->camera, preset);
  if (!image) return image;
  CaptionText words = caption;
  if (words.viewLabel.empty()) words.viewLabel = scene->view->captionTitle;
  if (auto ok = drawCaptions(*image, preset.caption, words); !ok)
    return std::unexpected(ok.error());
  return image;
}

Result<Image> Renderer::drawPlain(const frame::History& history, int frame,
                                  const std::string& view) {
  auto scene = prepareScene(history, frame, view);
  if (!scene) return std::unexpected(scene.error());
  return impl_->plain.draw(*scene->mesh, scene->list, scene->camera);
}

Result<FloatImage> Renderer::signal(const frame::History& history, int frame,
                                    const std::string& view) {
  auto scene = prepareScene(history, frame, view);
  if (!scene) return std::unexpected(scene.error());
  return impl_->fluoro.signal(*scene->mesh, scene->list, scene->camera, impl_->preset, frame);
}

Result<std::map<std::string, int>> Renderer::visiblePixels(const frame::History& history, int frame,
                                                           const std::string& view) {
  auto scene = prepareScene(history, frame, view);
  if (!scene) return std::unexpected(scene.error());
  std::set<std::string> promised;
  for (const auto& [structure, least] : scene->view->shows)
    promised.insert(structure == kBolusInMouth ? kBolus : structure);
  return scene->view->style == Style::fluoro
             ? impl_->fluoro.visiblePixels(*scene->mesh, scene->list, scene->camera, impl_->preset,
                                           promised)
             : impl_->surface.visiblePixels(*scene->mesh, scene->list, scene->camera,
                                            impl_->preset);
}

namespace {
// A bolus that is mostly swallowed, or for the tongue views mostly past the ramus, need not be seen
// any more.
bool expected(const frame::History& h, int frame, const std::string& structure) {
  if (!structure.starts_with(kBolus)) return true;
  const std::size_t k = static_cast<std::size_t>(frame),
                    n = h.bolus.positions.empty() ? 0 : h.bolus.positions[k].size();
  if (n == 0) return false;
  std::size_t here = n;
  if (structure == kBolusInMouth && !h.bolus.region.empty())
    here = std::ranges::count(h.bolus.region[k], frame::Region::oral);
  else if (structure == kBolus && !h.bolus.state.empty())
    here = std::ranges::count_if(h.bolus.state[k], frame::isThere);
  return 2 * here > n;
}

// Promises about the bolus are made for 5 mL; a smaller one has less to be seen.
double sizeOf(const frame::History& h, const std::string& structure) {
  if (!structure.starts_with(kBolus) || h.bolus.positions.empty()) return 1;
  const double offered_m3 =
      static_cast<double>(h.bolus.positions.front().size()) * h.bolus.particleVolume_m3;
  return std::min(1.0, std::pow(offered_m3 / kPromisedBolus_m3, 2. / 3));
}
}  // namespace

Result<std::vector<Loss>> Renderer::lost(const frame::History& history, int frame,
                                         const std::string& view) {
  auto seen = visiblePixels(history, frame, view);
  if (!seen) return std::unexpected(seen.error());
  const double lines = impl_->preset.height / 720.0;
  std::vector<Loss> losses;
  for (const auto& [structure, least720] : impl_->preset.views.at(view).shows) {
    const int least = static_cast<int>(least720 * lines * lines * sizeOf(history, structure));
    const int pixels = (*seen)[structure == kBolusInMouth ? kBolus : structure];
    if (pixels < least && expected(history, frame, structure))
      losses.push_back({structure, pixels, least});
  }
  return losses;
}
}  // namespace swallowclip::render
