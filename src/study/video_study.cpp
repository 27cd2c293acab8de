// SPDX-License-Identifier: MIT
#include "study/video_study.h"

#include "video/video_reader.h"

namespace swallowclip::study {
namespace {
// Of a file that counts no frames, what its end may lack; assumed, range 0.05 to 0.5
constexpr double kMissing_s = 0.1;

class VideoStudy : public Study {
 public:
  explicit VideoStudy(StudyDef def) : def_(std::move(def)) {}

  /// First reading: times, and whether all of it can be decoded.
  Result<void> scan() {
    if (auto begun = rewind(); !begun) return begun;
    info_.width = reader_->info().width;
    info_.height = reader_->info().height;
    bool timed = true;
    for (;;) {
      auto frame = reader_->next();
      if (!frame) return std::unexpected(frame.error());
      if (!*frame) break;
      if (info_.frames() == kMaxFrames)
        return refuse(fmt::format("holds more than {} frames", kMaxFrames),
                      "Cut out the swallow first.");
      timed = timed && (*frame)->timed;
      info_.time_s.push_back((*frame)->time_s);
    }
    const video::VideoInfo& video = reader_->info();
    if (info_.time_s.empty())
      return refuse("holds no frames", "Name a file with a moving picture.");
    if (video.frames > 0 && video.frames != info_.frames())
      return refuse(
          fmt::format("says that it holds {} frames, {} can be read", video.frames, info_.frames()),
          "It is cut off or damaged: copy it again.");
    if (video.frames == 0 && video.read_s > 0 && video.duration_s - video.read_s > kMissing_s)
      return refuse(fmt::format("says that it lasts {:.2f} s, but ends at {:.2f} s",
                                video.duration_s, video.read_s),
                    "It is cut off or damaged: copy it again.");
    if (auto told = tellTimes(timed); !told) return told;
    info_.kind = "video";
    if (video.interlaced)
      info_.warnings.push_back("interlaced: every frame shows two moments, 1/2 frame apart");
    if (video.stretched) info_.warnings.push_back("pixels are not square: made square");
    if (video.quarterTurns)
      info_.warnings.push_back(
          fmt::format("turned by {} degrees, as the file asks for", 90 * video.quarterTurns));
    return rewind();
  }

  Result<Image> frame(int k) override {
    if (k < next_)
      if (auto begun = rewind(); !begun) return std::unexpected(begun.error());
    for (;;) {
      auto frame = reader_->next();
      if (!frame) return std::unexpected(frame.error());
      if (!*frame) return refuse(fmt::format("has no frame {} any more", k), "Was it changed?");
      if (next_++ == k) return std::move((*frame)->image);
    }
  }

 private:
  Result<void> rewind() {
    auto reader = video::VideoReader::open({def_.path, {}, kPlace});
    if (!reader) return std::unexpected(reader.error());
    reader_ = std::move(*reader);
    next_ = 0;
    return {};
  }

  Result<void> tellTimes(bool timed) {
    if (!timed && def_.frameRate_hz <= 0)
      return refuse("holds no frame times", "Give its rate with --frame-rate.");
    if (timed && def_.frameRate_hz > 0)
      info_.warnings.push_back("--frame-rate replaces the frame times of the file");
    info_.timing = def_.frameRate_hz > 0 ? "--frame-rate" : "time stamps of the container";
    const double first_s = info_.time_s.front();
    for (std::size_t i = 0; i < info_.time_s.size(); ++i)
      info_.time_s[i] = def_.frameRate_hz > 0 ? static_cast<double>(i) / def_.frameRate_hz
                                              : info_.time_s[i] - first_s;
    return {};
  }

  StudyDef def_;
  std::unique_ptr<video::VideoReader> reader_;
  int next_ = 0;  ///< frame that the reader hands out next
};
}  // namespace

Result<std::unique_ptr<Study>> openVideo(const StudyDef& def) {
  auto study = std::make_unique<VideoStudy>(def);
  if (auto read = study->scan(); !read) return std::unexpected(read.error());
  return std::unique_ptr<Study>(std::move(study));
}
}  // namespace swallowclip::study
