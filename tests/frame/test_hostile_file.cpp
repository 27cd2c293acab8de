// SPDX-License-Identifier: MIT
// Broken and dishonest history files: always an error that names the place, never a crash.
#include <hdf5.h>

#include <fstream>
#include <functional>

#include "core/file.h"
#include "frame/history_file.h"
#include "frame/sample_history.h"

namespace swallowclip::frame {
namespace {

void put(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<long>(bytes.size()));
}

/// What a hostile editor does to one data set.
void replace(hid_t file, const std::string& path, const std::vector<hsize_t>& shape, hid_t type,
             const void* values, hsize_t chunk = 0) {
  H5Ldelete(file, path.c_str(), H5P_DEFAULT);
  const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  const hid_t create = H5Pcreate(H5P_DATASET_CREATE);
  if (chunk > 0) {
    const std::vector<hsize_t> chunks(shape.size(), chunk);
    H5Pset_chunk(create, static_cast<int>(shape.size()), chunks.data());
  }
  const hid_t set = H5Dcreate2(file, path.c_str(), type, space, H5P_DEFAULT, create, H5P_DEFAULT);
  if (values) H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  H5Dclose(set);
  H5Pclose(create);
  H5Sclose(space);
}

void setWhole(hid_t file, const char* owner, const char* name, int value) {
  H5Adelete_by_name(file, owner, name, H5P_DEFAULT);
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t a = H5Acreate_by_name(file, owner, name, H5T_STD_I32LE, space, H5P_DEFAULT,
                                    H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(a, H5T_NATIVE_INT, &value);
  H5Aclose(a);
  H5Sclose(space);
}

class HostileFile : public testing::Test {
 protected:
  void SetUp() override {
    path_ = folder_ / "run.h5";
    ASSERT_TRUE(saveHistory(sampleHistory(), path_));
    bytes_ = *readFile(path_);
  }
  /// The error after `edit`; must name the file and `place`, and say what to do.
  void expectError(const std::function<void(hid_t)>& edit, const std::string& place) {
    put(path_, bytes_);
    const hid_t file = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    edit(file);
    ASSERT_GE(H5Fclose(file), 0);
    const Result<History> loaded = loadHistory(path_);
    ASSERT_FALSE(loaded) << "no error for " << place;
    const std::string text = loaded.error().text();
    EXPECT_NE(text.find(path_.string()), std::string::npos) << text;
    EXPECT_NE(text.find(place), std::string::npos) << text;
    EXPECT_FALSE(loaded.error().remedy.empty()) << text;
  }

  Scratch folder_;
  std::filesystem::path path_;
  std::string bytes_;
};

TEST_F(HostileFile, TruncatedAnywhere) {
  std::vector<std::size_t> cuts;
  for (std::size_t cut = 0; cut < 64; ++cut) cuts.push_back(cut);
  for (std::size_t cut = 64; cut < bytes_.size(); cut += bytes_.size() / 400) cuts.push_back(cut);
  cuts.push_back(bytes_.size() - 1);
  for (std::size_t cut : cuts) {
    put(path_, std::string_view(bytes_).substr(0, cut));
    const Result<History> loaded = loadHistory(path_);
    ASSERT_FALSE(loaded) << "cut at " << cut << " of " << bytes_.size();
    EXPECT_EQ(loaded.error().kind, ErrorKind::usage);
  }
}

TEST_F(HostileFile, FlippedBytesAreNoticedOrHarmless) {
  const History h = sampleHistory();
  int noticed = 0, tried = 0;
  for (std::size_t at = 0; at < bytes_.size(); at += 23) {
    std::string damaged = bytes_;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
    put(path_, damaged);
    const Result<History> loaded = loadHistory(path_);
    ++tried;
    if (!loaded) {
      ++noticed;
      continue;
    }
    for (int f = 0; f < h.frames(); ++f) ASSERT_EQ(loaded->digest(f), h.digest(f)) << "at " << at;
  }
  RecordProperty("noticed_percent", 100 * noticed / tried);
}

TEST_F(HostileFile, OtherKindsOfFile) {
  EXPECT_EQ(loadHistory(folder_ / "absent.h5").error().problem, "no such file");
  EXPECT_NE(loadHistory(folder_.path()).error().problem.find("not a file"), std::string::npos);
  put(path_, "this is a letter, not a history");
  EXPECT_NE(loadHistory(path_).error().problem.find("HDF5"), std::string::npos);
}

TEST_F(HostileFile, EachMissingPartIsNamed) {
  for (const char* place :
       {"/meta", "/time_s", "/structures", "/structures/tongue", "/structures/tongue/positions",
        "/structures/hyoid/pose", "/structures/hyoid/rest", "/skin", "/skin/wall", "/skin/film_m",
        "/skin/velocities", "/bolus", "/bolus/id", "/bolus/state", "/bolus/region", "/landmarks",
        "/events/time_s", "/ledger"})
    expectError([&](hid_t f) { H5Ldelete(f, place, H5P_DEFAULT); }, place);
  expectError([](hid_t f) { H5Adelete_by_name(f, "/meta", "fps", H5P_DEFAULT); }, "/meta@fps");
}

TEST_F(HostileFile, WrongVersion) {
  expectError([](hid_t f) { setWhole(f, "/meta", "version", 99); }, "version is 99, 1 expected");
  expectError([](hid_t f) { setWhole(f, "/structures/hyoid", "rigid", 2); }, "0 or 1");
}

TEST_F(HostileFile, WrongShapesAndTypes) {
  const std::vector<float> zeros(100000, 0.0f);
  const auto shaped = [&](const char* path, std::vector<hsize_t> shape, hid_t type,
                          const std::string& expectation) {
    expectError([&](hid_t f) { replace(f, path, shape, type, zeros.data()); }, path);
    expectError([&](hid_t f) { replace(f, path, shape, type, zeros.data()); }, expectation);
  };
  shaped("/skin/positions", {5, 16}, H5T_NATIVE_FLOAT, "[5,16,3] expected");
  shaped("/skin/positions", {4, 16, 3}, H5T_NATIVE_FLOAT, "[4,16,3], [5,16,3] expected");
  shaped("/skin/positions", {5, 16, 3}, H5T_NATIVE_INT, "real numbers expected");
  shaped("/bolus/state", {5, 7}, H5T_NATIVE_FLOAT, "whole numbers expected");
  shaped("/structures/hyoid/pose", {5, 6}, H5T_NATIVE_FLOAT, "[5,7] expected");
  shaped("/structures/tongue/triangles", {18, 4}, H5T_NATIVE_INT, "[any,3] expected");
  shaped("/skin/u", {}, H5T_NATIVE_FLOAT, "[16] expected");
  expectError([&](hid_t f) { replace(f, "/time_s", {0}, H5T_NATIVE_DOUBLE, nullptr); }, "0 frames");
  expectError([&](hid_t f) { replace(f, "/bolus/id", {7}, H5T_NATIVE_INT, zeros.data()); },
              "entry 1 is 0, 1 expected");
}

TEST_F(HostileFile, HugeSizesAreRefusedBeforeTheyAreAllocated) {
  const hsize_t huge = hsize_t{1} << 40;
  expectError([&](hid_t f) { replace(f, "/skin/wall", {huge}, H5T_NATIVE_UINT8, nullptr, 1024); },
              "/skin/wall");
  expectError([&](hid_t f) { replace(f, "/time_s", {huge}, H5T_NATIVE_DOUBLE, nullptr, 1024); },
              "too large");
  expectError(
      [&](hid_t f) {
        replace(f, "/structures/tongue/rest", {huge, 3}, H5T_NATIVE_FLOAT, nullptr, 3);
      },
      "too large");
  // Small enough to allocate, but never written.
  expectError([&](hid_t f) { replace(f, "/time_s", {50000000}, H5T_NATIVE_DOUBLE, nullptr, 1024); },
              "more than is stored");
}

TEST_F(HostileFile, UnsoundValues) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> bad(5 * 16 * 3, nan);
  const std::vector<int> far(18 * 3, 1000);
  const std::vector<int> state(5 * 7, 250);
  expectError(
      [&](hid_t f) {
        replace(f, "/skin/positions", {5, 16, 3}, H5T_NATIVE_FLOAT, bad.data());
      },
      "skin positions frame 0");
  expectError(
      [&](hid_t f) {
        replace(f, "/skin/triangles", {18, 3}, H5T_NATIVE_INT, far.data());
      },
      "skin triangles");
  expectError(
      [&](hid_t f) {
        replace(f, "/bolus/state", {5, 7}, H5T_NATIVE_INT, state.data());
      },
      "bolus state");
}

TEST_F(HostileFile, LinksOutOfTheFileAreNotFollowed) {
  ASSERT_TRUE(saveHistory(sampleHistory(), folder_ / "other.h5"));
  expectError(
      [](hid_t f) {
        H5Ldelete(f, "/skin", H5P_DEFAULT);
        H5Lcreate_external("other.h5", "/skin", f, "/skin", H5P_DEFAULT, H5P_DEFAULT);
      },
      "/skin");
  expectError(
      [](hid_t f) {
        H5Ldelete(f, "/skin/u", H5P_DEFAULT);
        H5Lcreate_soft("/skin/s_m", f, "/skin/u", H5P_DEFAULT, H5P_DEFAULT);
      },
      "/skin/u");
}
}  // namespace
}  // namespace swallowclip::frame
