// SPDX-License-Identifier: MIT
#include <thread>

#include "core/file.h"
#include "frame/history_file.h"
#include "frame/sample_history.h"

namespace swallowclip::frame {
namespace {

void expectSame(const History& a, const History& b) {
  ASSERT_EQ(a.frames(), b.frames());
  EXPECT_EQ(a.time_s, b.time_s);
  for (int f = 0; f < a.frames(); ++f) EXPECT_EQ(a.digest(f), b.digest(f)) << "frame " << f;
  ASSERT_EQ(a.structures.size(), b.structures.size());
  for (std::size_t k = 0; k < a.structures.size(); ++k) {
    EXPECT_EQ(a.structures[k].name, b.structures[k].name);
    EXPECT_EQ(a.structures[k].material, b.structures[k].material);
    EXPECT_EQ(a.structures[k].rigid, b.structures[k].rigid);
    EXPECT_EQ(a.structures[k].triangles, b.structures[k].triangles);
    EXPECT_EQ(a.structures[k].rest, b.structures[k].rest);
  }
  EXPECT_EQ(a.skin.triangles, b.skin.triangles);
  EXPECT_EQ(a.skin.wall, b.skin.wall);
  EXPECT_EQ(a.skin.s_m, b.skin.s_m);
  EXPECT_EQ(a.skin.u, b.skin.u);
  EXPECT_EQ(a.bolus.particleVolume_m3, b.bolus.particleVolume_m3);
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  for (std::size_t k = 0; k < a.landmarks.size(); ++k) {
    EXPECT_EQ(a.landmarks[k].name, b.landmarks[k].name);
    EXPECT_EQ(a.landmarks[k].positions, b.landmarks[k].positions);
  }
  ASSERT_EQ(a.plannedEvents.size(), b.plannedEvents.size());
  for (std::size_t k = 0; k < a.plannedEvents.size(); ++k) {
    EXPECT_EQ(a.plannedEvents[k].name, b.plannedEvents[k].name);
    EXPECT_EQ(a.plannedEvents[k].time_s, b.plannedEvents[k].time_s);
  }
  ASSERT_EQ(a.ledger.size(), b.ledger.size());
  for (std::size_t k = 0; k < a.ledger.size(); ++k) {
    EXPECT_EQ(a.ledger[k].start, b.ledger[k].start);
    EXPECT_EQ(a.ledger[k].escaped, b.ledger[k].escaped);
    EXPECT_EQ(a.ledger[k].film, b.ledger[k].film);
  }
  const Meta &m = a.meta, &n = b.meta;
  EXPECT_EQ(m.scene + m.swallow + m.bolus + m.solver + m.program + m.inputsSha256,
            n.scene + n.swallow + n.bolus + n.solver + n.program + n.inputsSha256);
  EXPECT_EQ(m.component, n.component);
  EXPECT_EQ(m.score, n.score);
  EXPECT_EQ(m.cues_s, n.cues_s);
  EXPECT_EQ(std::vector({m.fps, m.cue_s, m.density_kgm3, m.viscosity_Pas, m.bariumSulfate_kgm3,
                         m.particleSpacing_m, m.meanDensityError, m.maxDensityError,
                         m.shareAboveTenPercent, m.maxSpeed_ms}),
            std::vector({n.fps, n.cue_s, n.density_kgm3, n.viscosity_Pas, n.bariumSulfate_kgm3,
                         n.particleSpacing_m, n.meanDensityError, n.maxDensityError,
                         n.shareAboveTenPercent, n.maxSpeed_ms}));
}

TEST(HistoryFile, ReadsBackBitForBit) {
  const Scratch folder;
  const History h = sampleHistory();
  const Result<void> saved = saveHistory(h, folder / "run.h5");
  ASSERT_TRUE(saved) << saved.error().text();
  const Result<History> loaded = loadHistory(folder / "run.h5");
  ASSERT_TRUE(loaded) << loaded.error().text();
  expectSame(h, *loaded);
}

TEST(HistoryFile, ReadsBackWhatParticlesHaveLentToTheWalls) {
  History h = sampleHistory();
  const std::uint64_t without = h.digest(1);
  for (const auto& row : h.bolus.state) h.bolus.lentShare.emplace_back(row.size(), 0.25f);
  h.bolus.state[1][0] = ParticleState::coating;
  EXPECT_NE(h.digest(1), without);
  const Scratch folder;
  ASSERT_TRUE(saveHistory(h, folder / "run.h5"));
  const auto back = loadHistory(folder / "run.h5");
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(back->bolus.lentShare, h.bolus.lentShare);
  EXPECT_EQ(back->digest(1), h.digest(1));
  EXPECT_NEAR(back->bolus.volume_m3(1, 0), 0.75 * h.bolus.particleVolume_m3, 1e-20);
}

TEST(HistoryFile, ReadsBackWithoutBolusSkinAndExtras) {
  const Scratch folder;
  History h = sampleHistory(3, 4, 0);  // frames of no particles
  h.skin = {};
  h.landmarks.clear();
  h.plannedEvents.clear();
  h.ledger.clear();
  h.meta.cues_s.clear();
  h.meta.bolus.clear();
  ASSERT_TRUE(saveHistory(h, folder / "run.h5"));
  const Result<History> loaded = loadHistory(folder / "run.h5");
  ASSERT_TRUE(loaded) << loaded.error().text();
  expectSame(h, *loaded);
  EXPECT_TRUE(loaded->bolus.positions.empty());
}

TEST(HistoryFile, SameHistorySameBytes) {
  const Scratch folder;
  ASSERT_TRUE(saveHistory(sampleHistory(), folder / "a.h5"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 times count seconds
  std::vector<std::vector<char>> clutter(50, std::vector<char>(100000, 'x'));  // other heap content
  ASSERT_TRUE(saveHistory(sampleHistory(), folder / "b.h5"));
  EXPECT_TRUE(*readFile(folder / "a.h5") == *readFile(folder / "b.h5"));
}

TEST(HistoryFile, SavesFromTwoThreadsAtOnce) {
  const Scratch folder;
  ASSERT_TRUE(saveHistory(sampleHistory(), folder / "a.h5"));
  const auto work = [&](const char* name) {
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(saveHistory(sampleHistory(), folder / name));
      ASSERT_TRUE(loadHistory(folder / name));
    }
  };
  std::thread other(work, "b.h5");
  work("c.h5");
  other.join();
  EXPECT_TRUE(*readFile(folder / "a.h5") == *readFile(folder / "b.h5"));
  EXPECT_TRUE(*readFile(folder / "a.h5") == *readFile(folder / "c.h5"));
}

TEST(HistoryFile, NormalSwallowFitsInFortyMegabytes) {
  const Scratch folder;
  // 40k triangles of structures are about 20k vertices, here 3 x 6400; skin 6400; 621 particles.
  const History h = sampleHistory(109, 80, 621);
  ASSERT_TRUE(saveHistory(h, folder / "run.h5"));
  const auto bytes = std::filesystem::file_size(folder / "run.h5");
  RecordProperty("bytes", static_cast<int>(bytes));
  EXPECT_LE(bytes, 40u << 20);
}

TEST(HistoryFile, UnsoundHistoryIsNotSaved) {
  const Scratch folder;
  History h = sampleHistory();
  h.skin.u.pop_back();
  const Result<void> saved = saveHistory(h, folder / "run.h5");
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().problem.find("skin u"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(HistoryFile, MissingFolderIsAnErrorAndNothingStays) {
  const Scratch folder;
  const Result<void> saved = saveHistory(sampleHistory(), folder / "nowhere/run.h5");
  ASSERT_FALSE(saved);
  EXPECT_FALSE(saved.error().remedy.empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(HistoryFile, FullDiskIsAnErrorAndTheOldFileStays) {
  const Scratch folder;
  ASSERT_TRUE(saveHistory(sampleHistory(3, 3, 2), folder / "run.h5"));
  const std::string before = *readFile(folder / "run.h5");
  std::filesystem::create_symlink("/dev/full", asidePath(folder / "run.h5"));
  const Result<void> saved = saveHistory(sampleHistory(30, 20, 100), folder / "run.h5");
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().problem.find("No space"), std::string::npos) << saved.error().text();
  EXPECT_TRUE(*readFile(folder / "run.h5") == before);
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().stem(), "run");
  EXPECT_TRUE(loadHistory(folder / "run.h5"));
}

TEST(HistoryFile, SideFileNamesTheData) {
  const Scratch folder;
  ASSERT_TRUE(saveHistory(sampleHistory(), folder / "run.h5"));
  const Result<std::string> text = readFile(folder / "run.xdmf");
  ASSERT_TRUE(text);
  for (const char* part : {"run.h5:/structures/tongue/positions", "run.h5:/structures/hyoid/rest",
                           "run.h5:/skin/velocities", "run.h5:/bolus/positions", "Temporal"})
    EXPECT_NE(text->find(part), std::string::npos) << part;
}
}  // namespace
}  // namespace swallowclip::frame
