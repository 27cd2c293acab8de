// SPDX-License-Identifier: MIT
#include <cstdlib>

#include "cli/run.h"
#include "library/nightly.h"
#include "library/perform.h"
#include "overlay/overlay.h"
#include "pipeline/interrupt.h"
#include "pipeline/pipeline.h"
#include "verify/verify.h"

int main(int argc, char** argv) {
  using namespace swallowclip;
  pipeline::catchInterrupts();
  // Scenes, presets and shaders: beside the sources, unless a package says otherwise.
  const char* data = std::getenv("SWALLOWCLIP_DATA");
  const cli::Handlers handlers{
      {cli::kRender, pipeline::render},
      {cli::kSimulate, pipeline::simulate},
      {cli::kSweep, pipeline::sweep},
      {cli::kMeasure, pipeline::measure},
      {cli::kDraw, pipeline::draw},
      {cli::kExport, pipeline::exportHistory},
      {cli::kImport, pipeline::importMeshes},
      {cli::kList, pipeline::list},
      {cli::kCheck, pipeline::check},
      {cli::kConfusion, pipeline::confusion},
      {cli::kVerify, verify::verify},
      {cli::kEvents, overlay::events},
      {cli::kOverlay, overlay::overlay},
      {cli::kNightly, library::nightly},
      {cli::kJob, library::job},
  };
  return cli::run({argv + std::min(argc, 1), argv + argc}, data ? data : SWALLOWCLIP_SOURCE_DIR,
                  handlers);
}
