// SPDX-License-Identifier: MIT
// The house keeps its arrows: who includes whom (rooms.txt), which room owns which library, who
// speaks and who ends the process, and how long a file may be. Reads the sources as text.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {
namespace fs = std::filesystem;
const fs::path kRoot = SWALLOWCLIP_SOURCE_DIR;
constexpr int kMaxLines = 400;  // STYLE: budget of a file

struct Source {
  std::string path, room;          // "src/core/vec.h", "core"
  std::vector<std::string> lines;  // as written
};

std::vector<Source> sources() {
  std::vector<Source> all;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "src")) {
    const std::string extension = entry.path().extension();
    if (extension != ".h" && extension != ".cpp") continue;
    Source source;
    const fs::path relative = fs::relative(entry.path(), kRoot / "src");
    source.path = (fs::path("src") / relative).string();
    source.room = relative.begin()->string();
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);) source.lines.push_back(line);
    all.push_back(std::move(source));
  }
  return all;
}

std::map<std::string, std::set<std::string>> permissions() {
  std::map<std::string, std::set<std::string>> allowed;
  std::ifstream in(kRoot / "tests/architecture/rooms.txt");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(':');
    if (line.starts_with('#') || colon == std::string::npos) continue;
    std::istringstream words(line.substr(colon + 1));
    std::set<std::string>& rooms = allowed[line.substr(0, colon)];
    rooms.insert(line.substr(0, colon));
    for (std::string word; words >> word;) rooms.insert(word);
  }
  return allowed;
}

/// Without "..." texts and // comments, so that words in them do not count.
std::string codeOf(const std::string& line) {
  static const std::regex text(R"("(?:[^"\\]|\\.)*")");
  const std::string plain = std::regex_replace(line, text, "\"\"");
  return plain.substr(0, plain.find("//"));
}

/// "path:line: text" of every line whose code matches, outside the rooms given.
std::vector<std::string> findings(const std::regex& pattern,
                                  const std::set<std::string>& exceptRooms,
                                  const std::set<std::string>& exceptFiles = {}) {
  std::vector<std::string> found;
  for (const Source& source : sources()) {
    if (exceptRooms.contains(source.room) || exceptFiles.contains(source.path)) continue;
    for (std::size_t i = 0; i < source.lines.size(); ++i)
      if (std::regex_search(codeOf(source.lines[i]), pattern))
        found.push_back(source.path + ":" + std::to_string(i + 1) + ": " + source.lines[i]);
  }
  return found;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text.append(line).append("\n");
  return text;
}
}  // namespace

TEST(Architecture, RoomsIncludeOnlyWhatLiesBelow) {
  const auto allowed = permissions();
  const std::regex include(R"(^\s*#\s*include\s*"([^"]+)\")");
  int count = 0;
  for (const Source& source : sources()) {
    ASSERT_TRUE(allowed.contains(source.room)) << source.room << " is not in rooms.txt";
    for (const std::string& line : source.lines) {
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      const std::string target = match[1];
      const std::size_t slash = target.find('/');
      ++count;
      if (slash == std::string::npos) {
        ADD_FAILURE() << source.path << ": include " << target << " from src/, as \"room/file.h\"";
        continue;
      }
      const auto& rooms = allowed.at(source.room);
      EXPECT_TRUE(rooms.contains(target.substr(0, slash)) || rooms.contains(target))
          << source.path << ": " << source.room << " must not include " << target;
    }
  }
  EXPECT_GT(count, 20) << "hardly any include lines found: is the pattern still right?";
}

TEST(Architecture, EveryLibraryHasItsRoom) {
  const std::vector<std::pair<const char*, std::set<std::string>>> owners{
      {"nlohmann/", {"scene"}},
      {"(GL|EGL|KHR)/", {"render"}},
      {"(pango|cairo|freetype)", {"render", "plot"}},
      {"lib(av|sw)[a-z]+/", {"video"}},
      {"x264", {"video"}},
      {"(hdf5|H5)", {"frame"}},
      {"assimp/", {"anatomy", "frame"}},
      {"CGAL/", {"anatomy"}},
      {"dcmtk/|gdcm", {"study"}},
      {"CLI/", {"cli"}},
      {"iostream>", {"cli"}},
  };
  for (const auto& [header, rooms] : owners) {
    const std::regex pattern(std::string(R"(^\s*#\s*include\s*<)") + header);
    EXPECT_EQ(joined(findings(pattern, rooms)), "") << header << " belongs to " << *rooms.begin();
  }
}

TEST(Architecture, OnlyCliSpeaksAndEndsTheProcess) {
  // core's failed CHECK says on standard error what was wrong before it aborts.
  const std::set<std::string> checks{"src/core/error.cpp"};
  EXPECT_EQ(joined(findings(std::regex(R"(\b(cout|cerr|clog|printf|fprintf|puts|putchar|stdout)\b)"
                                       R"(|\bfmt::print\b)"),
                            {"cli"}, checks)),
            "");
  // The decoder's child process ends itself, and nobody else.
  const std::set<std::string> ends{"src/core/error.cpp", "src/study/dicom_study.cpp"};
  EXPECT_EQ(
      joined(findings(std::regex(R"((^|[^.>\w])(std::)?(_?exit|_Exit|quick_exit|abort)\s*\()"),
                      {"cli"}, ends)),
      "");
}

TEST(Architecture, NothingIsRandomOrHidden) {
  EXPECT_EQ(joined(findings(std::regex(R"(\b(random_device|srand|rand)\b\s*\(?)"), {})), "");
  EXPECT_EQ(joined(findings(std::regex(R"(#\s*if\s+0\b)"), {})), "");
}

TEST(Architecture, FilesKeepTheirBudget) {
  for (const Source& source : sources()) {
    ASSERT_FALSE(source.lines.empty()) << source.path << " is empty";
    EXPECT_EQ(source.lines[0], "// SPDX-License-Identifier: MIT") << source.path;
    EXPECT_LE(static_cast<int>(source.lines.size()), kMaxLines) << source.path;
  }
}
