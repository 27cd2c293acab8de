# SPDX-License-Identifier: MIT
# Run at build time: cmake -DSOURCE=... -DOUTPUT=... -DCOMPILER=... -P stage_versions.cmake
# Writes one digest per stage over all sources that shape its products, so that no one has to think
# of raising a version number. Remarks in the sources count too: redrawing once too often is cheap,
# a stale clip is not.
set(work library/perform.cpp)
set(simulate core/* anatomy/* kinematics/* biomech/* airway/* bolus/* frame/* scene/json_* scene/curves.*
    scene/anatomy_file.* scene/bolus_file.* scene/lumen_file.* scene/mapping_file.* scene/swallow_file.*
    pipeline/simulation.* pipeline/scene_loader.* pipeline/checkpoint.* ${work})
set(measure core/* frame/* scoring/* scene/side_file.* ${work})
set(draw core/* frame/* scoring/* render/* video/* scene/json_* scene/preset_file.* pipeline/clips.*
    pipeline/components.* ${work})
set(verify core/* video/* library/clip_check.* ${work})

set(text "// Made by stage_versions.cmake.\n#pragma once\nnamespace swallowclip::library {\n")
foreach(stage simulate measure draw verify)
  list(TRANSFORM ${stage} PREPEND ${SOURCE}/src/)
  file(GLOB files LIST_DIRECTORIES false ${${stage}})
  list(FILTER files INCLUDE REGEX "\\.(h|cpp)$")
  list(SORT files)
  set(sums "${COMPILER}")
  foreach(file ${files})
    file(SHA256 ${file} sum)
    file(RELATIVE_PATH name ${SOURCE} ${file})
    string(APPEND sums "\n${sum} ${name}")
  endforeach()
  string(SHA256 digest "${sums}")
  string(APPEND text "inline constexpr const char* ${stage}Digest = \"${digest}\";\n")
endforeach()
string(APPEND text "}\n")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "${text}" @ONLY)
