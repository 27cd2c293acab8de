// SPDX-License-Identifier: MIT
#include "pipeline/simulation.h"

#include <chrono>
#include <cmath>

#include "airway/airway_skin.h"
#include "biomech/model.h"
#include "bolus/solver.h"
#include "core/digest.h"
#include "kinematics/choreography.h"
#include "kinematics/events.h"
#include "pipeline/checkpoint.h"
#include "pipeline/interrupt.h"
#include "scene/bolus_file.h"
#include "scene/json_text.h"
#include "scene/swallow_file.h"

namespace swallowclip::pipeline {
namespace {
constexpr double kCubicMetrePerMl = 1e-6;
constexpr double kTongueKept = 0.98;        // DESIGN section 3
constexpr double kDeepestGroove_m = 32e-3;  // of a tongue 40 mm high, clinical-reference 5; assumed
constexpr double kSequenceRate_hz = 34;     // 109 meshes over 3.18 s, thesis 3.2
constexpr double kNasopharynxFloor_m = -0.022;  // contact level of the raised velum, this scene

std::vector<Vec3f> toFloat(const std::vector<Vec3>& p) {
  std::vector<Vec3f> f;
  f.reserve(p.size());
  for (const Vec3& v : p) f.push_back(v.cast<float>());
  return f;
}

airway::SkinningDef skinningDef() {
  using frame::Wall;
  const auto wall = [](Wall w, const char* name) {
    return airway::WallMasters{static_cast<std::uint8_t>(w), {name}};
  };
  airway::SkinningDef d;
  d.walls = {wall(Wall::palate, "maxilla"),
             wall(Wall::velum, "soft_palate"),
             wall(Wall::posterior, "pharyngeal_wall"),
             wall(Wall::tongue, "tongue"),
             wall(Wall::larynx, "larynx_mucosa"),
             wall(Wall::esophagus, "esophagus")};
  d.seam_m = 0;  // the sheets of the parametric scene meet exactly
  return d;
}

frame::Region regionOf(bolus::State state, std::uint8_t branch, double s_m, double z_m) {
  using frame::Region;
  if (state == bolus::State::swallowed) return Region::swallowed;
  if (branch == 1 && z_m > kNasopharynxFloor_m) return Region::nasopharynx;
  if (branch == 2) return Region::larynx;
  if (s_m < 0.072) return Region::oral;  // borders: DESIGN section 2
  if (s_m < 0.122) return Region::oropharynx;
  if (s_m < 0.150) return Region::hypopharynx;
  return Region::esophagus;
}

constexpr int kCheckpointFrames = 5;  // between writing checkpoints: some seconds, assumed

void appendBolus(const bolus::Solver& solver, frame::History& h) {
  const bolus::Particles& p = solver.particles();
  frame::BolusTrack& b = h.bolus;
  b.positions.push_back(toFloat(p.positions));
  b.velocities.push_back(toFloat(p.velocities));
  b.densityRatio.emplace_back(p.densityRatio.begin(), p.densityRatio.end());
  b.s_m.emplace_back(p.s_m.begin(), p.s_m.end());
  auto& state = b.state.emplace_back();
  auto& region = b.region.emplace_back();
  for (std::size_t i = 0; i < p.state.size(); ++i) {
    state.push_back(static_cast<frame::ParticleState>(p.state[i]));
    region.push_back(regionOf(p.state[i], p.branch[i], p.s_m[i], p.positions[i].z()));
  }
  if (solver.coating().on()) {
    auto& lent = b.lentShare.emplace_back();
    for (const double m3 : solver.coating().lent_m3())
      lent.push_back(static_cast<float>(m3 / solver.particleVolume_m3()));
    const std::vector<double> thickness_m = solver.coatingThickness_m();
    h.skin.film_m.emplace_back(thickness_m.begin(), thickness_m.end());
  }
  const bolus::Ledger l = solver.ledger();
  h.ledger.push_back({l.start, l.fluid, l.film, l.swallowed, l.escaped});
}

void startStructures(const biomech::Model& model, frame::History& h) {
  for (const biomech::ModelStructure& s : model.structures()) {
    frame::StructureTrack t;
    t.name = s.name;
    t.material = s.material;
    t.rigid = s.rigid;
    t.triangles = s.rest.triangles;
    t.rest = toFloat(s.rest.positions);
    h.structures.push_back(std::move(t));
  }
}

void appendStructures(const biomech::ModelState& state, frame::History& h) {
  for (std::size_t i = 0; i < h.structures.size(); ++i) {
    if (h.structures[i].rigid)
      h.structures[i].poses.push_back(state.structures[i].worldFromRest);
    else
      h.structures[i].positions.push_back(toFloat(state.structures[i].positions));
  }
}

/// By meaning: neither remarks nor other boluses of the list count.
Result<std::string> inputsHash(const RunOptions& o,
                               const std::vector<std::filesystem::path>& files) {
  std::string all = std::string(SWALLOWCLIP_VERSION) + "\n";
  for (const auto& f : files) {
    auto text = scene::canonicalJson(f, "boluses", o.bolus);
    if (!text) return std::unexpected(text.error());
    all += sha256Hex(*text) + " " + f.filename().string() + "\n";
  }
  for (const TrackSetting& s : o.sets) all += fmt::format("{}.{}={}\n", s.track, s.key, s.value);
  all += fmt::format("{} {} {} {}\n", o.bolus, o.volume_mL, o.spacing_mm, o.solver);
  return sha256Hex(all);
}

struct Moving {
  biomech::Model model;
  airway::BakedSkin skin;
  kinematics::SequenceSampler landmarks;
  std::vector<std::string> landmarkNames;
};

void noteLostVolume(const kinematics::StructureSequence& tongue, double whole_m3,
                    Progress& progress) {
  double least = 1;
  for (const std::vector<Vec3>& frame : tongue.frames)
    least = std::min(least, volume(frame, tongue.triangles) / whole_m3);
  if (least < kTongueKept)
    progress.note(
        fmt::format("at its most displaced the tongue has {:.0f} % of its volume: this bolus "
                    "takes more room than the floor of the mouth can give",
                    least * 100));
}

Result<Moving> setInMotion(const LoadedScene& scene, const kinematics::SwallowDef& swallow,
                           int threads, Progress& progress) {
  kinematics::BakedMotion baked =
      kinematics::bake(scene.rigid, *scene.lumen, *scene.soft, swallow, kSequenceRate_hz);
  noteLostVolume(baked.sequence.structures.front(), scene.soft->tongueVolume_m3(), progress);
  auto model = biomech::Model::build(baked.sequence);
  if (!model) return std::unexpected(model.error());
  const anatomy::SkinLayout& layout = scene.lumen->skin();
  airway::BindSkin bind;
  bind.mesh = {scene.lumen->skinPositions(scene.lumen->evaluate(scene.lumen->neutralPose())),
               layout.triangles};
  bind.wall = layout.wall;
  bind.s_m = layout.s_m;
  bind.u = layout.u;
  bind.branch = layout.branch;
  auto skin = airway::attachSkin(std::move(bind), *model, skinningDef());
  if (!skin) return std::unexpected(skin.error());
  auto motion = skin->bake(
      *model,
      {.rate_hz = kSequenceRate_hz, .blend = airway::TimeBlend::convex, .threads = threads});
  if (!motion) return std::unexpected(motion.error());
  return Moving{std::move(*model), std::move(*motion),
                kinematics::SequenceSampler(0, kSequenceRate_hz, std::move(baked.landmarks)),
                std::move(baked.landmarkNames)};
}

Result<bolus::Solver> startBolus(const RunOptions& o, const kinematics::SwallowDef& swallow,
                                 const bolus::Fluid& fluid, const bolus::WallMotion& walls) {
  bolus::BolusDef def;
  def.fluid = fluid;
  def.spacing_m = o.spacing_mm * kMetrePerMm;
  def.volume_m3 = swallow.volume_m3;
  def.gravity_ms2 = swallow.gravity_ms2;
  auto kind = bolus::solverFromName(o.solver);
  if (!kind) return std::unexpected(kind.error());
  def.solver = *kind;
  bolus::Solver solver(def, walls, o.jobs);
  if (auto seeded = solver.seed(0, {0, 0.066}); !seeded) return std::unexpected(seeded.error());
  if (auto relaxed = solver.relax(0); !relaxed) return std::unexpected(relaxed.error());
  return solver;
}

void finishMeta(const bolus::Solver& solver, frame::Meta& m) {
  const bolus::Stats& s = solver.stats();
  m.meanDensityError = s.meanDensityError;
  m.maxDensityError = s.maxDensityError;
  m.shareAboveTenPercent = s.shareAboveTenPercent;
  m.maxSpeed_ms = s.maxSpeed_ms;
  m.steps = s.steps;
  m.velocityClamps = s.clamped;
}
}  // namespace

Result<kinematics::SwallowDef> loadSwallow(const RunOptions& o, int score,
                                           std::filesystem::path* file) {
  std::filesystem::path path = o.swallow;
  if (path.empty()) {
    if (o.component == 0)
      return usageError("--component", "neither a component nor a swallow file is given",
                        "Add --component 4 --score 0 or --swallow FILE.");
    path = o.scenesFolder() / "swallows" / fmt::format("c{:02}-s{}.json", o.component, score);
    std::error_code ec;
    if (!std::filesystem::exists(path, ec))
      return usageError(
          path.string(),
          fmt::format("no swallow file for component {}, score {}", o.component, score),
          "Components 4, 5, 8, 13 and 15 are built in; for others write a swallow file and give it "
          "with --swallow.");
  }
  if (file) *file = path;
  auto swallow = scene::loadSwallow(path);
  if (!swallow) return swallow;
  swallow->offer(o.volume_mL * kCubicMetrePerMl);
  for (const TrackSetting& s : o.sets)
    if (auto set = scene::applySet(*swallow, fmt::format("{}.{}={}", s.track, s.key, s.value));
        !set)
      return std::unexpected(set.error());
  return swallow;
}

Result<frame::History> simulateSwallow(const RunOptions& o, int score, double fps,
                                       Progress& progress, SolverCost* cost) {
  std::filesystem::path swallowFile;
  auto swallow = loadSwallow(o, score, &swallowFile);
  if (!swallow) return std::unexpected(swallow.error());
  return simulateSwallow(o, *swallow, swallowFile, fps, progress, cost);
}

Result<frame::History> simulateSwallow(const RunOptions& o, const kinematics::SwallowDef& swallow,
                                       const std::filesystem::path& swallowFile, double fps,
                                       Progress& progress, SolverCost* cost) {
  auto scene = loadScene(o);
  if (!scene) return std::unexpected(scene.error());
  for (const std::string& n : scene->notes) progress.note(n);
  auto swallowFiles = scene::swallowFiles(swallowFile);
  if (!swallowFiles) return std::unexpected(swallowFiles.error());
  scene->files.insert(scene->files.end(), swallowFiles->begin(), swallowFiles->end());

  frame::History h;
  frame::Meta& m = h.meta;
  m.scene = o.scene;
  m.swallow = swallow.name;
  if (o.hasBolus() && o.volume_mL != RunOptions{}.volume_mL)
    m.swallow += fmt::format("+volume={:g}mL", o.volume_mL);
  for (const TrackSetting& set : o.sets)
    m.swallow += fmt::format("+{}.{}={:g}", set.track, set.key, set.value);
  m.bolus = "none";
  m.solver = o.hasBolus() ? o.solver : "none";
  m.program = std::string("swallowclip ") + SWALLOWCLIP_VERSION;
  m.component = swallow.component;
  m.score = swallow.score;
  m.fps = fps;
  m.cues_s = swallow.cues_s;
  m.particleSpacing_m = o.spacing_mm * kMetrePerMm;
  bolus::Fluid fluid;
  if (o.hasBolus()) {
    auto file = scene::loadBolus(o.scenesFolder(), o.bolus);
    if (!file) return std::unexpected(file.error());
    fluid = file->fluid;
    m.bolus = file->name;
    m.density_kgm3 = fluid.density_kgm3;
    m.bariumSulfate_kgm3 = file->bariumSulfate_kgm3;
    m.viscosity_Pas = bolus::apparentViscosity_Pas(fluid, 50);  // at 50/s, clinical-reference 4
    scene->files.push_back(o.bolus.ends_with(".json") ? std::filesystem::path(o.bolus)
                                                      : o.scenesFolder() / "boluses.json");
  }
  auto hash = inputsHash(o, scene->files);
  if (!hash) return std::unexpected(hash.error());
  m.inputsSha256 = *hash;

  const kinematics::Choreography choreography(*scene->lumen, swallow);
  if (choreography.grooveDepth_m() > kDeepestGroove_m)
    return usageError(
        "bolus",
        fmt::format("to hold {:g} mL this tongue would lie {:.0f} mm below the palate",
                    swallow.volume_m3 / kCubicMetrePerMl, choreography.grooveDepth_m() * 1e3),
        fmt::format("offer less, so that {:g} mm suffice", kDeepestGroove_m * 1e3));
  auto moving = setInMotion(*scene, swallow, o.jobs, progress);
  if (!moving) return std::unexpected(moving.error());
  bolus::WallMotion walls = moving->skin.wallMotion();
  walls.sealed = [&choreography](double t, int branch) { return choreography.sealed(t, branch); };
  std::optional<bolus::Solver> solver;
  if (o.hasBolus()) {
    auto started = startBolus(o, swallow, fluid, walls);
    if (!started) return std::unexpected(started.error());
    solver.emplace(std::move(*started));
    h.bolus.particleVolume_m3 = solver->particleVolume_m3();
  }
  startStructures(moving->model, h);
  h.skin.triangles = walls.triangles;
  for (std::uint8_t w : walls.wall) h.skin.wall.push_back(static_cast<frame::Wall>(w));
  h.skin.s_m.assign(walls.s_m.begin(), walls.s_m.end());
  h.skin.u.assign(walls.u.begin(), walls.u.end());
  for (const std::string& name : moving->landmarkNames) h.landmarks.push_back({name, {}});
  for (const auto& [name, time] : kinematics::plannedEvents(swallow))
    h.plannedEvents.push_back({name, time});

  std::error_code ec;
  const bool keeps = solver && !o.checkpoint.empty();
  if (keeps && std::filesystem::exists(o.checkpoint, ec)) {
    if (auto read = readCheckpoint(o.checkpoint, *solver, h); !read)
      return std::unexpected(read.error());
    progress.note(
        fmt::format("going on from {} at frame {}", o.checkpoint.string(), h.ledger.size()));
  }
  const int frames = static_cast<int>(std::floor(swallow.duration_s * fps + 1e-9)) + 1;
  std::vector<Vec3> p, v;
  SolverCost spent;
  const std::int64_t stepsBefore = solver ? solver->stats().steps : 0;
  for (int k = 0; k < frames; ++k) {
    if (interrupted()) return std::unexpected(interruptedError());
    const double t = k / fps;
    const bool isNew = k >= static_cast<int>(h.ledger.size());
    if (solver && isNew) {
      const auto start = std::chrono::steady_clock::now();
      auto step = solver->advanceTo(t);
      spent.wall_s +=
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (!step) {
        Error e = step.error();
        e.remedy +=
            fmt::format("\n  Replay: {} (stopped at frame {} of {})", o.commandLine, k, frames);
        return std::unexpected(e);
      }
      appendBolus(*solver, h);
      if (keeps && k % kCheckpointFrames == kCheckpointFrames - 1)
        if (auto kept = writeCheckpoint(o.checkpoint, *solver, h); !kept)
          return std::unexpected(kept.error());
    }
    h.time_s.push_back(t);
    moving->skin.at(t, p, v);
    h.skin.positions.push_back(toFloat(p));
    h.skin.velocities.push_back(toFloat(v));
    appendStructures(moving->model.at(t), h);
    moving->landmarks.at(t, p, v);
    for (std::size_t i = 0; i < h.landmarks.size(); ++i)
      h.landmarks[i].positions.push_back(p[i].cast<float>());
    progress.update(static_cast<double>(k + 1) / frames);
  }
  if (solver) {
    finishMeta(*solver, m);
    spent.steps = m.steps - stepsBefore;
    spent.particles = solver->particles().positions.size();
  }
  if (cost) *cost = spent;
  if (keeps) std::filesystem::remove(o.checkpoint, ec);
  return h;
}
}  // namespace swallowclip::pipeline
