// SPDX-License-Identifier: MIT
// What a person has marked in a study: at which frames the events fall, and where landmarks lie.
// Read from JSON (study.events.json, docs/overlay.md) or from a table saved as CSV. Messages name
// rows and keys, never a cell's text, which might name the patient.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/vec.h"
#include "study/study.h"

namespace swallowclip::overlay {

struct StudyEvent {
  std::string name;  ///< ASPEKT word, see eventNames()
  int frame = 0;
};

struct MarkedPoint {
  std::string name;           ///< see landmarkKinds()
  std::optional<int> frame;   ///< empty: holds for the whole clip
  Vec2 at_px = Vec2::Zero();  ///< x right, y down, from the upper left corner of the study
};

/// Two ends of something of known length, e.g. a coin under the chin.
struct Calibration {
  Vec2 from_px = Vec2::Zero(), to_px = Vec2::Zero();
  double length_m = 0;

  double pixelsPerMetre() const { return (to_px - from_px).norm() / length_m; }
};

enum class ScaleFrom { landmarks, calibration };

struct Marks {
  std::vector<StudyEvent> events;  ///< by frame
  std::vector<MarkedPoint> points;
  std::optional<Calibration> calibration;
  bool facesRight = false;  ///< the patient's nose points to the right of the picture
  ScaleFrom scale = ScaleFrom::landmarks;
};

/// Events that can be marked, in the order of clinical-reference section 3.
const std::vector<std::string>& eventNames();

/// Points that can be marked; `fixed` ones belong to skull and spine and show head motion.
struct LandmarkKind {
  const char* name;
  bool fixed;
};
const std::vector<LandmarkKind>& landmarkKinds();
std::vector<std::string> landmarkNames();
/// The known name that is meant, whatever its capitals, blanks and hyphens; else a suggestion.
Result<std::string> knownName(const std::string& word, const std::vector<std::string>& known,
                              const char* what, const std::string& place);

/// Checked against the study: frames and points lie in it, events are in a possible order, no two
/// landmarks of a frame share a spot.
Result<Marks> loadMarks(const std::filesystem::path& path, const study::StudyInfo& study);
}  // namespace swallowclip::overlay
