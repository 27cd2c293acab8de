// SPDX-License-Identifier: MIT
#include "core/file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

using namespace swallowclip;
namespace fs = std::filesystem;

namespace {
/// A folder of its own for every test, gone afterwards.
class FileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "swallowclip-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder = pattern;
  }
  void TearDown() override { fs::remove_all(folder); }
  int entries() const {
    return static_cast<int>(
        std::distance(fs::directory_iterator(folder), fs::directory_iterator{}));
  }
  fs::path folder;
};
}  // namespace

TEST_F(FileTest, RoundTripAndReplacement) {
  const std::string bytes("a\0b\xff\n", 5);
  ASSERT_TRUE(writeFile(folder / "x.bin", bytes));
  EXPECT_EQ(readFile(folder / "x.bin").value(), bytes);
  ASSERT_TRUE(writeFile(folder / "x.bin", "new"));
  EXPECT_EQ(readFile(folder / "x.bin").value(), "new");
  EXPECT_EQ(entries(), 1) << "something was left aside";
}

TEST_F(FileTest, EmptyFileIsNotAnError) {
  ASSERT_TRUE(writeFile(folder / "empty", ""));
  const auto text = readFile(folder / "empty");
  ASSERT_TRUE(text) << text.error().text();
  EXPECT_EQ(*text, "");
}

TEST_F(FileTest, AsideNameKeepsTheExtensionAndIsHidden) {
  const fs::path aside = asidePath(folder / "clip.mp4");
  EXPECT_EQ(aside.parent_path(), folder);
  EXPECT_EQ(aside.extension(), ".mp4");
  EXPECT_TRUE(aside.filename().string().starts_with("."));
}

TEST_F(FileTest, UnwritablePlacesAreNamedAndLeaveNothing) {
  ASSERT_TRUE(writeFile(folder / "file", "old"));
  const auto below = writeFile(folder / "file" / "x.txt", "new");  // a file is no folder
  ASSERT_FALSE(below);
  EXPECT_NE(below.error().place.find("x.txt"), std::string::npos) << below.error().text();
  fs::create_directory(folder / "taken");
  EXPECT_FALSE(writeFile(folder / "taken", "new"));  // a folder stands there already
  EXPECT_EQ(readFile(folder / "file").value(), "old");
  EXPECT_EQ(entries(), 2) << "something was left aside";
  EXPECT_FALSE(prepareFolder(folder / "file" / "sub"));
  EXPECT_FALSE(prepareFolder("/proc/swallowclip"));
}

TEST_F(FileTest, FullDiskKeepsTheOldFile) {
  ASSERT_TRUE(writeFile(folder / "x.txt", "old"));
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tiny{4096, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tiny);
  const auto done = writeFile(folder / "x.txt", std::string(100'000, 'n'));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(done);
  EXPECT_EQ(readFile(folder / "x.txt").value(), "old");
  EXPECT_EQ(entries(), 1) << "something was left aside";
}

TEST_F(FileTest, PrepareFolderMakesParents) {
  ASSERT_TRUE(prepareFolder(folder / "a/b/c"));
  EXPECT_TRUE(fs::is_directory(folder / "a/b/c"));
  EXPECT_TRUE(fs::is_empty(folder / "a/b/c"));
}

TEST_F(FileTest, ReadingAFolderOrNothingFails) {
  EXPECT_FALSE(readFile(folder));
  EXPECT_EQ(readFile(folder / "none").error().kind, ErrorKind::usage);
}
