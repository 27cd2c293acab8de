// SPDX-License-Identifier: MIT
// A history on disk: HDF5 (NAME.h5) plus a text side file (NAME.xdmf) that lets ParaView and VisIt
// open the same numbers as moving surfaces and points (in ParaView take "XDMF Reader", the one for
// version 2; the "Xdmf3" ones don't know its functions). Same history, same bytes.
//
// Schema, version 1 (kHistoryVersion). F frames, V vertices, T triangles, N particles, L landmarks,
// E events, C cues. SI units; x left, y posterior, z superior. float32 unless stated; int32 where
// (i), uint8 where (b), float64 where (d).
//
//   /meta        @version @component @score (i), @scene @swallow @bolus @solver @program
//                @inputs_sha256 @units (text), @fps @cue_s @density_kgm3 @viscosity_Pas
//                @particle_spacing_m @mean_density_error @max_density_error
//                @share_above_ten_percent @max_speed_ms (d)
//                cues_s [C] (d)
//   /time_s      [F] (d)
//   /structures  @names: one per line, in order
//     /NAME      @material, @rigid (i, 0 or 1), triangles [T,3] (i), rest [V,3], and either
//                pose [F,7] (d; qw qx qy qz tx ty tz, moves `rest`) or positions [F,V,3]
//   /skin        triangles [T,3] (i), wall [V] (b), s_m [V], u [V], positions [F,V,3],
//                velocities [F,V,3], film_m [F,T] or [0,T]
//   /bolus       @particle_volume_m3 (d), id [N] (i), positions [F,N,3], velocities [F,N,3],
//                density_ratio [F,N], s_m [F,N],
//                state [F,N] (b: 0 fluid, 1 film, 2 swallowed, 3 coating), region [F,N] (b: 0 oral,
//                1 oropharynx, 2 nasopharynx, 3 hypopharynx, 4 larynx, 5 esophagus, 6 swallowed),
//                lent_share [F,N] (of its volume, on the walls as film_m; only when walls are
//                coated)
//   /landmarks   @names: one per line; positions [F,L,3]
//   /events      @names: one per line; time_s [E] (d)
//   /ledger      [F,5] (i: start, fluid, film, swallowed, escaped) or [0,5]
//
// Nothing else is optional: without skin V and T are 0, without a bolus N is 0.
//
// Poses and times stay float64: they are few, and what is read is what was written, bit for bit.
#pragma once
#include <filesystem>
#include <string>

#include "core/error.h"
#include "frame/history.h"

namespace swallowclip::frame {

/// Validates, then publishes `path` and its side file whole or not at all. A run without fluid
/// has no particles: per-frame lists of length zero come back as empty lists.
Result<void> saveHistory(const History& history, const std::filesystem::path& path);

/// Never trusts the file: shapes, sizes, ranges and numbers are checked, and what comes back
/// validates. An error names the file and the data set.
Result<History> loadHistory(const std::filesystem::path& path);

/// The side file's text, for a history stored in a file called `h5Name` next to it.
std::string xdmfText(const History& history, const std::string& h5Name);
}  // namespace swallowclip::frame
