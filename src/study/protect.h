// SPDX-License-Identifier: MIT
// Keeps burned-in text of a study out of every picture: what lies outside the X-ray's opening
// (collimator or image intensifier) and under given rectangles becomes black. Nothing goes on
// while the file does not rule such text out and the user has not dealt with it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "study/study.h"

namespace swallowclip::study {

/// Pixels of the study, origin in the upper left corner.
struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

struct ProtectDef {
  std::vector<Rectangle> masks;
  bool noBurnedInText = false;  ///< the user vouches for it
  bool keepBorder = false;      ///< leave what lies outside the opening
};

class Protector {
 public:
  /// Reads frames to find the opening: there quantum noise makes neighbouring frames differ.
  static Result<Protector> make(Study& study, const ProtectDef& def);
  void apply(Image& image) const;
  /// Bounding box of what remains visible.
  const Rectangle& opening() const { return opening_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  Result<void> findOpening(Study& study);

  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> visible_;  ///< [pixel] 0 or 1
  Rectangle opening_;
  std::vector<std::string> notes_;
};
}  // namespace swallowclip::study
