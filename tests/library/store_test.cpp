// SPDX-License-Identifier: MIT
#include "library/store.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>

#include "core/digest.h"
#include "data.h"
#include "library/sealed.h"

namespace swallowclip::library {
namespace {
namespace fs = std::filesystem;
const std::string kKey = "0123456789abcdef0123456789abcdef";
const std::string kOther = "fedcba9876543210fedcba9876543210";

class StoreTest : public test::Library {
 protected:
  StoreTest() { root = openRoot(options.library.out, true).value(); }

  void put(const std::string& key, const std::string& bytes = "bytes") {
    const fs::path part = partFolder(root, key);
    ASSERT_TRUE(prepareFolder(part));
    ASSERT_TRUE(writeFile(part / "a.bin", bytes));
    Marker m;
    m.key = key;
    m.stage = "draw";
    m.name = "draw \"it\"";
    m.cpu_s = 1.5;
    ASSERT_TRUE(publishProduct(root, part, m));
  }
  Store::State check(const std::string& key) {
    Stamps stamps(root.run() / "stamps.tsv");
    auto state = Store(root, stamps).check(key, true);
    EXPECT_TRUE(stamps.save());
    return state;
  }
  Root root;
};

TEST_F(StoreTest, AProductIsThereWholeOrNotAtAll) {
  EXPECT_EQ(check(kKey).why, "not made yet");
  put(kKey);
  const auto state = check(kKey);
  ASSERT_TRUE(state.marker) << state.why;
  EXPECT_EQ(state.marker->name, "draw \"it\"");
  EXPECT_DOUBLE_EQ(state.marker->cpu_s, 1.5);
  ASSERT_EQ(state.marker->files.size(), 1u);
  EXPECT_EQ(state.marker->files[0].sha256, sha256Hex("bytes"));
  put(kKey);  // a second one of the same key finds the first
  EXPECT_TRUE(check(kKey).marker);
  EXPECT_FALSE(fs::exists(partFolder(root, kKey)));
}

TEST_F(StoreTest, DamageOfEveryKindIsNoticedAndClearedAway) {
  const fs::path file = root.product(kKey) / "a.bin", marker = root.product(kKey) / "done.json";
  const std::vector<std::pair<const char*, std::function<void()>>> damages{
      {"one byte", [&] { std::ofstream(file) << "bytez"; }},
      {"cut", [&] { fs::resize_file(file, 2); }},
      {"gone", [&] { fs::remove(file); }},
      {"a link in its place",
       [&] {
         fs::rename(file, folder / "elsewhere");
         fs::create_symlink(folder / "elsewhere", file);
       }},
      {"a link to itself",
       [&] {
         fs::remove(file);
         fs::create_symlink("a.bin", file);
       }},
      {"marker gone", [&] { fs::remove(marker); }},
      {"marker cut", [&] { fs::resize_file(marker, 100); }},
      {"marker of another",
       [&] {
         put(kOther);
         fs::copy_file(root.product(kOther) / "done.json", marker,
                       fs::copy_options::overwrite_existing);
       }},
  };
  for (const auto& [what, damage] : damages) {
    put(kKey);
    ASSERT_TRUE(check(kKey).marker) << what;
    damage();
    const auto state = check(kKey);
    EXPECT_FALSE(state.marker) << what;
    EXPECT_NE(state.why, "not made yet") << what;
    EXPECT_FALSE(fs::exists(root.product(kKey))) << what;
    put(kKey);
    EXPECT_TRUE(check(kKey).marker) << what;
  }
}

TEST_F(StoreTest, AByteChangedBehindTheClockIsNoticedByTheChangeTime) {
  put(kKey);
  ASSERT_TRUE(check(kKey).marker);
  const fs::path file = root.product(kKey) / "a.bin";
  const auto time = fs::last_write_time(file);
  std::fstream(file, std::ios::in | std::ios::out) << "B";
  fs::last_write_time(file, time);
  EXPECT_FALSE(check(kKey).marker);
}

TEST_F(StoreTest, DamagedStampsOnlyCostHashing) {
  put(kKey);
  ASSERT_TRUE(check(kKey).marker);
  std::string text = readFile(root.run() / "stamps.tsv").value();
  text[3] = text[3] == '0' ? '1' : '0';
  std::ofstream(root.run() / "stamps.tsv") << text;
  EXPECT_TRUE(check(kKey).marker);
  std::ofstream(root.run() / "stamps.tsv") << "\xff\xfe nonsense \n seal";
  EXPECT_TRUE(check(kKey).marker);
}

TEST_F(StoreTest, PruningTakesLeftoversAndTheOldestBeyondTheLimit) {
  put(kKey, std::string(1000, 'a'));
  put(kOther, std::string(1000, 'b'));
  fs::last_write_time(root.product(kKey), fs::file_time_type::clock::now() - std::chrono::hours(9));
  const fs::path leftover = root.store() / "01" / ("." + kKey + ".77.part");
  fs::create_directories(leftover);
  Stamps stamps(root.run() / "stamps.tsv");
  Store store(root, stamps);
  EXPECT_EQ(store.prune({kKey, kOther}, 0), 1);
  EXPECT_FALSE(fs::exists(leftover));
  EXPECT_EQ(store.prune({}, 1e-6), 1);  // one kilobyte fits
  EXPECT_FALSE(fs::exists(root.product(kKey)));
  EXPECT_TRUE(fs::exists(root.product(kOther)));
  EXPECT_EQ(store.prune({kOther}, 0), 0);
  EXPECT_EQ(store.prune({}, 0), 1);
}

TEST_F(StoreTest, ASealedFileTellsOfEveryChangedByte) {
  const fs::path file = folder / "s.json";
  const std::string text = sealed("\"a\": 1, \"b\": \"x\"");
  for (std::size_t k = 0; k < text.size(); ++k) {
    std::string bad = text;
    bad[k] ^= 1;
    std::ofstream(file) << bad;
    EXPECT_FALSE(readSealed(file)) << k;
  }
  std::ofstream(file) << text;
  const auto good = readSealed(file);
  ASSERT_TRUE(good);
  EXPECT_EQ(good->root().integer("a", 0, 9), 1);
}

TEST_F(StoreTest, RootsThatAreNotOursAreRefused) {
  std::ofstream(folder / "file") << "x";
  EXPECT_FALSE(openRoot(folder / "file", true));

  fs::create_directories(folder / "photos");
  std::ofstream(folder / "photos/a.jpg") << "x";
  const auto others = openRoot(folder / "photos", true);
  ASSERT_FALSE(others);
  EXPECT_NE(others.error().text().find("other things"), std::string::npos);

  fs::create_symlink("loop2", folder / "loop1");
  fs::create_symlink("loop1", folder / "loop2");
  for (const char* path : {"loop1", "loop1/below"}) {
    const auto loop = openRoot(folder / path, true);
    ASSERT_FALSE(loop) << path;
    EXPECT_NE(loop.error().text().find("circle"), std::string::npos) << loop.error().text();
  }

  fs::remove_all(root.store());
  fs::create_symlink(folder / "photos", root.store());
  const auto link = openRoot(root.path, true);
  ASSERT_FALSE(link);
  EXPECT_NE(link.error().text().find("symbolic link"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "photos/a.jpg"));
  fs::remove(root.store());

  fs::create_directory(root.current());
  EXPECT_FALSE(openRoot(root.path, true));
}

TEST_F(StoreTest, AForeignOwnedRootIsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  ASSERT_EQ(::chown(root.path.c_str(), 65534, 65534), 0);
  const auto foreign = openRoot(root.path, true);
  ASSERT_FALSE(foreign);
  EXPECT_NE(foreign.error().text().find("belongs to user 65534"), std::string::npos);
}

TEST_F(StoreTest, AReadOnlyRootIsRefused) {
  const auto readOnly = openRoot("/proc/swallowclip", true);  // not even root can write there
  ASSERT_FALSE(readOnly);
  EXPECT_NE(readOnly.error().text().find("/proc"), std::string::npos);
}

TEST_F(StoreTest, TwoNightsExcludeEachOtherAndADeadOneLetsGo) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto lock = Lock::take(root, false);
    if (::write(ends[1], "x", 1) == 1) ::pause();
  }
  char taken;
  ASSERT_EQ(::read(ends[0], &taken, 1), 1);
  const auto refused = Lock::take(root, false);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text().find(fmt::format("process {}", child)), std::string::npos)
      << refused.error().text();
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(Lock::take(root, false));
}
}  // namespace
}  // namespace swallowclip::library
