// SPDX-License-Identifier: MIT
#include "study/study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "study/dicom_study.h"
#include "study/video_study.h"

namespace swallowclip::study {
namespace {
/// A DICOM file says "DICM" after 128 bytes (PS3.10 section 7.1); old ones begin with a data
/// element, which GDCM tells apart, so their names decide.
bool isDicom(const std::filesystem::path& path) {
  std::array<char, 132> head{};
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), head.size());
  if (in.gcount() == 132 && std::equal(head.begin() + 128, head.end(), "DICM")) return true;
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".dcm" || extension == ".dicom" || extension == ".ima";
}

/// Warnings that hold for every kind.
void warn(StudyInfo& info) {
  const double rate = info.rate_hz();
  if (rate > 0 && rate < kReliableRate_hz - 0.5)
    info.warnings.push_back(
        fmt::format("{:.3g} pulses/s: below 30 some scores change (Bonilha 2013); shown as it is, "
                    "no frame is made up",
                    rate));
  double shortest = 1e9, longest = 0;
  for (std::size_t i = 1; i < info.time_s.size(); ++i) {
    shortest = std::min(shortest, info.time_s[i] - info.time_s[i - 1]);
    longest = std::max(longest, info.time_s[i] - info.time_s[i - 1]);
  }
  if (longest > 1.5 * shortest)
    info.warnings.push_back(fmt::format("frames last from {:.1f} to {:.1f} ms: variable rate",
                                        shortest * 1e3, longest * 1e3));
}
}  // namespace

std::unexpected<Error> refuse(std::string problem, std::string remedy) {
  return usageError(kPlace, std::move(problem), std::move(remedy));
}

double StudyInfo::rate_hz() const {
  if (time_s.size() < 2) return 0;
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  std::ranges::nth_element(steps, steps.begin() + static_cast<long>(steps.size() / 2));
  return 1 / steps[steps.size() / 2];
}

double StudyInfo::end_s() const {
  const double rate = rate_hz();
  return time_s.empty() ? 0 : time_s.back() + (rate > 0 ? 1 / rate : 0);
}

int StudyInfo::frameAt(double t_s) const {
  const auto after = std::ranges::upper_bound(time_s, t_s);
  return std::max(0, static_cast<int>(after - time_s.begin()) - 1);
}

Result<std::unique_ptr<Study>> Study::open(const StudyDef& def) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(def.path, ec))
    return refuse("no such file", "Check the name and the folder.");
  auto study = isDicom(def.path) ? openDicom(def) : openVideo(def);
  if (!study) return study;
  StudyInfo& info = (*study)->info_;
  if (info.time_s.empty()) return refuse("holds no frames", "Name a file with a moving picture.");
  for (std::size_t i = 1; i < info.time_s.size(); ++i)
    if (!(info.time_s[i] > info.time_s[i - 1]))
      return refuse(fmt::format("frame {} comes at {:.4f} s, not after frame {} at {:.4f} s", i,
                                info.time_s[i], i - 1, info.time_s[i - 1]),
                    "Export it again, or convert it to a constant frame rate.");
  warn(info);
  return study;
}
}  // namespace swallowclip::study
