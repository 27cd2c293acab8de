// SPDX-License-Identifier: MIT
#include "scoring/series.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vec.h"

namespace swallowclip::scoring {
namespace {

struct Biquad {
  double b0, b1, b2, a1, a2;
};

/// Bilinear 2nd-order Butterworth, cut pre-warped. Two passes narrow the band, so that each must
/// cut higher by (sqrt 2 - 1)^-1/4 on the analogue axis.
Biquad butterworth(double rate_Hz, double cutoff_Hz) {
  const double k = std::tan(kPi * cutoff_Hz / rate_Hz) / std::pow(std::sqrt(2.0) - 1, 0.25);
  const double root2 = std::sqrt(2.0);
  const double norm = 1 / (1 + root2 * k + k * k), gain = k * k * norm;
  return {gain, 2 * gain, gain, 2 * (k * k - 1) * norm, (1 - root2 * k + k * k) * norm};
}

void runFilter(const Biquad& f, std::vector<double>& x) {
  // Steady state of a constant x[0], so that the filter does not start with a step.
  double x1 = x.front(), x2 = x1, y1 = x1, y2 = x1;
  for (double& v : x) {
    const double y = f.b0 * v + f.b1 * x1 + f.b2 * x2 - f.a1 * y1 - f.a2 * y2;
    x2 = x1, x1 = v, y2 = y1, y1 = y, v = y;
  }
}

/// Time at which x crosses `level` between frames i-1 and i.
double crossing(std::span<const double> time_s, std::span<const double> x, int i, double level) {
  const double step = x[i] - x[i - 1];
  const double w = step == 0 ? 1 : std::clamp((level - x[i - 1]) / step, 0.0, 1.0);
  return time_s[i - 1] + w * (time_s[i] - time_s[i - 1]);
}
}  // namespace

std::vector<double> zeroPhaseLowPass(std::span<const double> x, double rate_Hz, double cutoff_Hz) {
  const int n = static_cast<int>(x.size());
  if (n < 4 || !(cutoff_Hz < 0.5 * rate_Hz)) return {x.begin(), x.end()};

  const int pad = std::min(n - 1, static_cast<int>(std::ceil(3 * rate_Hz / cutoff_Hz)));
  std::vector<double> y;
  y.reserve(n + 2 * pad);
  for (int i = pad; i > 0; --i) y.push_back(2 * x[0] - x[i]);
  y.insert(y.end(), x.begin(), x.end());
  for (int i = 1; i <= pad; ++i) y.push_back(2 * x[n - 1] - x[n - 1 - i]);

  const Biquad filter = butterworth(rate_Hz, cutoff_Hz);
  for (int pass = 0; pass < 2; ++pass) {
    runFilter(filter, y);
    std::reverse(y.begin(), y.end());
  }
  return {y.begin() + pad, y.begin() + pad + n};
}

std::vector<Run> runs(std::span<const double> x, double hysteresis) {
  std::vector<Run> out;
  const int n = static_cast<int>(x.size());
  if (n == 0) return out;
  int low = 0, high = 0, direction = 0, turn = 0;
  auto close = [&](int at) {
    out.push_back({turn, at, x[at] - x[turn]});
    turn = at;
  };
  for (int i = 1; i < n; ++i) {
    if (x[i] > x[high]) high = i;
    // The lowest point is where a rise leaves: the last of equal lows.
    if (x[i] <= x[low]) low = i;
    if (direction >= 0 && x[high] - x[i] >= hysteresis) {
      if (direction > 0)
        close(high);
      else
        turn = high;
      direction = -1, low = i;
    } else if (direction <= 0 && x[i] - x[low] >= hysteresis) {
      if (direction < 0)
        close(low);
      else
        turn = low;
      direction = 1, high = i;
    }
  }
  if (direction != 0) close(direction > 0 ? high : low);
  return out;
}

std::vector<Advance> advances(std::span<const double> time_s, std::span<const double> x,
                              double path, double speed, double slack) {
  std::vector<Advance> out;
  for (const Run& run : runs(x, slack)) {
    if (run.change < path) continue;
    for (int i = run.begin; i < run.end; ++i) {
      if ((x[i + 1] - x[i]) / (time_s[i + 1] - time_s[i]) <= speed) continue;
      out.push_back({run.begin, run.end, time_s[i]});
      break;
    }
  }
  return out;
}

std::optional<double> pathSlope(std::span<const double> time_s, std::span<const double> x,
                                int begin, int end, double fromShare, double toShare) {
  const double change = x[end] - x[begin];
  auto reach = [&](double share) -> std::optional<double> {
    const double level = x[begin] + share * change;
    for (int i = begin + 1; i <= end; ++i)
      if ((x[i] - level) * change >= 0) return crossing(time_s, x, i, level);
    return std::nullopt;
  };
  const auto from_s = reach(fromShare), to_s = reach(toShare);
  if (change == 0 || !from_s || !to_s || !(*to_s > *from_s)) return std::nullopt;
  return (toShare - fromShare) * change / (*to_s - *from_s);
}

double median(std::vector<double> x) {
  if (x.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(x.begin(), x.end());
  const std::size_t n = x.size();
  return n % 2 ? x[n / 2] : 0.5 * (x[n / 2 - 1] + x[n / 2]);
}

std::optional<int> firstFrame(std::span<const double> x, int from,
                              const std::function<bool(double)>& test) {
  for (int i = std::max(0, from); i < static_cast<int>(x.size()); ++i)
    if (test(x[i])) return i;
  return std::nullopt;
}
}  // namespace swallowclip::scoring
