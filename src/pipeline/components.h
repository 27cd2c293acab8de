// SPDX-License-Identifier: MIT
// The 17 components and 72 scores a clip can be named after. The wording is our own and says what a
// viewer sees in the clip; it is not the text of the MBSImP, for which training is needed.
#pragma once
#include <span>

namespace swallowclip::pipeline {

struct Component {
  int number;                           ///< 1..17
  const char* word;                     ///< for the command line, e.g. "bolus-transport"
  const char* title;                    ///< for captions
  std::span<const char* const> scores;  ///< what each score looks like, from 0

  int highestScore() const { return static_cast<int>(scores.size()) - 1; }
};

/// All components in order.
std::span<const Component> components();

/// nullptr unless `number` is 1 to 17.
const Component* findComponent(int number);
}  // namespace swallowclip::pipeline
