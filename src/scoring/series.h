// SPDX-License-Identifier: MIT
// Small measures of one scalar over time. Inputs are [frame] arrays of equal length, times in
// seconds and strictly rising; NaN is not allowed unless said.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace swallowclip::scoring {

/// Butterworth low-pass of 2nd order run forward and backward over odd-reflected ends; `cutoff_Hz`
/// is the -3 dB point of the two passes together (Winter 2009, Biomechanics, ch. 3.4). Returns the
/// input where the cut is not below the Nyquist frequency or there are fewer than 4 samples.
std::vector<double> zeroPhaseLowPass(std::span<const double> x, double rate_Hz, double cutoff_Hz);

/// A stretch between two turning points.
struct Run {
  int begin = 0, end = 0;  ///< frames of its extremes
  double change = 0;       ///< x[end] - x[begin]
};

/// Turning points that are confirmed once x has come back by `hysteresis`; first and last run too
/// when they are that long.
std::vector<Run> runs(std::span<const double> x, double hysteresis);

/// A rise found in a series.
struct Advance {
  int begin = 0, end = 0;
  double onset_s = 0;  ///< start of the first frame interval faster than wanted
};

/// Rises of at least `path`, uninterrupted but for backward steps < `slack`, that somewhere exceed
/// `speed`.
std::vector<Advance> advances(std::span<const double> time_s, std::span<const double> x,
                              double path, double speed, double slack);

/// Slope of x between the first crossings of the given shares of its change over [begin,end].
std::optional<double> pathSlope(std::span<const double> time_s, std::span<const double> x,
                                int begin, int end, double fromShare, double toShare);

/// Middle value (mean of the two middle ones); NaN when empty.
double median(std::vector<double> values);

/// First frame in [from, size) where `test` holds.
std::optional<int> firstFrame(std::span<const double> x, int from,
                              const std::function<bool(double)>& test);
}  // namespace swallowclip::scoring
