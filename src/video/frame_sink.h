// SPDX-License-Identifier: MIT
// Where pictures go, one by one: a clip, numbered PNG files, a digest, or nowhere. All formats are
// the same to whoever draws. Nothing appears under a final name before finish().
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"

namespace swallowclip::video {

class FrameSink {
 public:
  virtual ~FrameSink() = default;  ///< without finish(): everything written so far is removed
  /// The next frame. An error may belong to an earlier frame; after one, only destruction helps.
  virtual Result<void> push(const Image& image) = 0;
  /// Ends and publishes. At least one frame is expected.
  virtual Result<void> finish() = 0;
};

/// An H.264 web clip (see mp4_sink.cpp for every setting).
struct Mp4Def {
  std::filesystem::path path;
  int width = 1280, height = 720;               ///< even
  int rateNumerator = 30, rateDenominator = 1;  ///< frames/s, >= 30 (Bonilha 2013: lower rates
                                                ///< change MBSImP scores)
  int crf = 19;           ///< x264 constant quality, 1..51 (ecosystem note: 18 to 20)
  int keyframeEvery = 8;  ///< frames; measured: +12 % bytes over 30, every step back is quick
  std::string preset = "medium";  ///< x264 speed word
  int queuedFrames = 4;           ///< pictures that may wait for the encoder's thread
};
Result<std::unique_ptr<FrameSink>> makeMp4Sink(const Mp4Def& def);

/// FOLDER/STEM_00000.png and so on; all are published at finish().
Result<std::unique_ptr<FrameSink>> makePngSink(const std::filesystem::path& folder,
                                               const std::string& stem = "frame");

/// Digest over sizes and pixels of all frames, in order.
class HashSink : public FrameSink {
 public:
  Result<void> push(const Image& image) override;
  Result<void> finish() override;
  std::uint64_t digest() const { return digest_; }
  const std::vector<std::uint64_t>& frames() const { return frames_; }  ///< digest of each

 private:
  std::uint64_t digest_ = 0;
  std::vector<std::uint64_t> frames_;
};

/// Counts.
class NullSink : public FrameSink {
 public:
  Result<void> push(const Image&) override {
    ++count_;
    return {};
  }
  Result<void> finish() override { return {}; }
  int count() const { return count_; }

 private:
  int count_ = 0;
};
}  // namespace swallowclip::video
