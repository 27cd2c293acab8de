// SPDX-License-Identifier: MIT
// Topology of the airway-skin: built once, the same for every pose.
#include "anatomy/lumen.h"

namespace swallowclip::anatomy {
namespace {
constexpr int kMouthLoops = 2;  // labelled as the mouth of a branch
using IndexGrid = std::vector<std::vector<int>>;

void quad(std::vector<Triangle>& t, int a, int b, int c, int d, bool flip) {
  // a b / c d: a,b along columns, c below a. Skips triangles that a shared seam collapses.
  const auto add = [&](int i, int j, int k) {
    if (i == j || j == k || k == i) return;
    t.push_back(flip ? Triangle{i, k, j} : Triangle{i, j, k});
  };
  add(a, b, c);
  add(c, b, d);
}

// Tube from loop 0 through the depths, closed by a grid with its own inner vertices.
void addBranch(std::vector<Triangle>& t, const std::vector<int>& rim, int first, int depths,
               const Lumen::Hole& hole, bool flip) {
  const int loop = hole.loop(), nc = hole.columnSpan(), nr = hole.rowSpan();
  const auto at = [&](int d, int k) {
    return d == 0 ? rim[k % loop] : first + (d - 1) * loop + k % loop;
  };
  for (int d = 0; d < depths; ++d)
    for (int k = 0; k < loop; ++k)
      quad(t, at(d, k), at(d, k + 1), at(d + 1, k), at(d + 1, k + 1), flip);
  const int inner = first + depths * loop;
  IndexGrid grid(nr + 1, std::vector<int>(nc + 1));
  for (int k = 0; k < loop; ++k) {
    const auto [r, c] = hole.at(k);
    grid[r - hole.firstRow][c - hole.firstColumn] = at(depths, k);
  }
  for (int i = 1; i < nr; ++i)
    for (int j = 1; j < nc; ++j) grid[i][j] = inner + (i - 1) * (nc - 1) + j - 1;
  for (int i = 0; i < nr; ++i)
    for (int j = 0; j < nc; ++j)
      quad(t, grid[i][j], grid[i][j + 1], grid[i + 1][j], grid[i + 1][j + 1], flip);
}
}  // namespace

void Lumen::buildSkin() {
  const int nc = columns();
  const auto insideHole = [](const Hole& h, int r, int c) {
    return r > h.firstRow && r < h.lastRow && c > h.firstColumn && c < h.lastColumn;
  };
  const auto quadInHole = [](const Hole& h, int r, int c) {
    return r >= h.firstRow && r < h.lastRow && c >= h.firstColumn && c < h.lastColumn;
  };
  const auto wallOfF = [&](double at) {
    return at < def_.velumStart_m           ? WallId::palate
           : at <= s(port_.firstRow) + 1e-9 ? WallId::velum
           : at < def_.uesStart_m           ? WallId::posterior
                                            : WallId::esophagus;
  };
  const auto wallOfM = [&](double at) {
    return at <= def_.tongueEnd_m ? WallId::tongue
           : at < def_.uesStart_m ? WallId::larynx
                                  : WallId::esophagus;
  };
  const auto addVertex = [&](int sheet, int i, WallId wall, int branch, double sAt, double uAt) {
    source_.push_back({sheet, i});
    skin_.wall.push_back(static_cast<std::uint8_t>(wall));
    skin_.branch.push_back(static_cast<std::uint8_t>(branch));
    skin_.s_m.push_back(sAt);
    skin_.u.push_back(uAt);
    return static_cast<int>(source_.size()) - 1;
  };

  IndexGrid f(rows_, std::vector<int>(nc, -1)), m = f;
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < nc; ++c) {
      if (!insideHole(port_, r, c))
        f[r][c] = addVertex(0, index(r, c), wallOfF(s(r)), 0, s(r), u(c));
    }
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < nc; ++c) {
      if (c == 0 || c == nc - 1)
        m[r][c] = f[r][c];  // the lateral seam belongs to F
      else if (!insideHole(inletHole_, r, c))
        m[r][c] = addVertex(1, index(r, c), wallOfM(s(r)), 0, s(r), u(c));
    }
  std::vector<Triangle>& t = skin_.triangles;
  for (int r = 0; r + 1 < rows_; ++r)
    for (int c = 0; c + 1 < nc; ++c) {
      if (!quadInHole(port_, r, c))
        quad(t, f[r][c], f[r][c + 1], f[r + 1][c], f[r + 1][c + 1], false);
      if (!quadInHole(inletHole_, r, c))
        quad(t, m[r][c], m[r][c + 1], m[r + 1][c], m[r + 1][c + 1], true);
    }
  for (int c = 0; c + 1 < nc; ++c) {  // ends of the lumen: lips side and esophagus side
    quad(t, m[0][c], m[0][c + 1], f[0][c], f[0][c + 1], false);
    const int e = rows_ - 1;
    quad(t, f[e][c], f[e][c + 1], m[e][c], m[e][c + 1], false);
  }
  const auto addBranchVertices = [&](const Hole& hole, int sheet, int depths, int branch) {
    const int first = static_cast<int>(source_.size());
    const int loop = hole.loop();
    const double sMid = 0.5 * (s(hole.firstRow) + s(hole.lastRow));
    for (int d = 0; d < depths; ++d)
      for (int k = 0; k < loop; ++k) {
        const auto [r, c] = hole.at(k);
        const bool front = branch == 1 && r == hole.firstRow;
        const WallId wall = branch == 2 ? WallId::larynx
                            : front     ? WallId::velum
                                        : WallId::posterior;
        addVertex(sheet, d * loop + k, wall, d < kMouthLoops ? branch + 2 : branch, s(r), u(c));
      }
    const int inner = (hole.rowSpan() - 1) * (hole.columnSpan() - 1);
    for (int i = 0; i < inner; ++i)
      addVertex(sheet, depths * loop + i, branch == 2 ? WallId::larynx : WallId::posterior, branch,
                sMid, 0);
    return first;
  };
  std::vector<int> rim;
  for (int k = 0; k < port_.loop(); ++k) rim.push_back(f[port_.at(k)[0]][port_.at(k)[1]]);
  addBranch(t, rim, addBranchVertices(port_, 2, portDepths_, 1), portDepths_, port_, false);
  rim.clear();
  for (int k = 0; k < inletHole_.loop(); ++k)
    rim.push_back(m[inletHole_.at(k)[0]][inletHole_.at(k)[1]]);
  addBranch(t, rim, addBranchVertices(inletHole_, 3, inletDepths_, 2), inletDepths_, inletHole_,
            true);
}
}  // namespace swallowclip::anatomy
