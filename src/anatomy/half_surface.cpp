// SPDX-License-Identifier: MIT
#include "anatomy/half_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swallowclip::anatomy {

int HalfSurface::addVertex(const Vec3& p) {
  positions_.push_back(p);
  return static_cast<int>(positions_.size()) - 1;
}

Ring HalfSurface::addRow(const std::vector<Vec3>& points) {
  Ring row;
  row.reserve(points.size());
  for (const Vec3& p : points) row.push_back(addVertex(p));
  return row;
}

// The shorter diagonal gives the rounder triangles and is the same on both sides of the mirror.
void HalfSurface::addQuad(int a, int b, int c, int d) {
  const double ac = (positions_[a] - positions_[c]).squaredNorm();
  const double bd = (positions_[b] - positions_[d]).squaredNorm();
  if (ac <= bd) {
    triangles_.push_back({a, b, c});
    triangles_.push_back({a, c, d});
  } else {
    triangles_.push_back({a, b, d});
    triangles_.push_back({b, c, d});
  }
}

void HalfSurface::loft(const std::vector<Ring>& rows, bool closed,
                       const std::vector<GridWindow>& windows) {
  for (int r = 0; r + 1 < static_cast<int>(rows.size()); ++r) {
    const Ring &near = rows[r], &far = rows[r + 1];
    const int n = static_cast<int>(near.size()), columns = closed ? n : n - 1;
    for (int i = 0; i < columns; ++i) {
      const bool open = std::any_of(windows.begin(), windows.end(), [&](const GridWindow& w) {
        const int offset = ((i - w.column0) % n + n) % n;
        return r >= w.row0 && r < w.row1 && offset < w.column1 - w.column0;
      });
      if (!open) addQuad(near[i], near[(i + 1) % n], far[(i + 1) % n], far[i]);
    }
  }
}

void HalfSurface::capPole(const Ring& row, bool closed, int pole, bool ahead) {
  const int n = static_cast<int>(row.size());
  for (int i = 0; i < (closed ? n : n - 1); ++i) {
    const int a = row[i], b = row[(i + 1) % n];
    triangles_.push_back(ahead ? Triangle{a, b, pole} : Triangle{b, a, pole});
  }
}

void HalfSurface::capFold(const Ring& row) {
  const int n = static_cast<int>(row.size());
  for (int i = 0; 2 * i + 2 < n; ++i) {
    const int j = n - 1 - i;
    if (i + 1 == j - 1)
      triangles_.push_back({row[i], row[i + 1], row[j]});
    else if (i + 1 < j - 1)
      addQuad(row[i], row[i + 1], row[j - 1], row[j]);
  }
}

Ring HalfSurface::windowBorder(const std::vector<Ring>& rows, bool closed, const GridWindow& w) {
  Ring border;
  const int n = static_cast<int>(rows[0].size());
  auto at = [&](int r, int i) { return rows[r][closed ? ((i % n) + n) % n : i]; };
  for (int i = w.column0; i < w.column1; ++i) border.push_back(at(w.row0, i));
  for (int r = w.row0; r < w.row1; ++r) border.push_back(at(r, w.column1));
  for (int i = w.column1; i > w.column0; --i) border.push_back(at(w.row1, i));
  for (int r = w.row1; r > w.row0; --r) border.push_back(at(r, w.column0));
  return border;
}

namespace {
// Drops vertices that no triangle uses (inside windows).
void compact(TriMesh& mesh) {
  std::vector<int> renumbered(mesh.positions.size(), -1);
  std::vector<Vec3> kept;
  for (Triangle& t : mesh.triangles)
    for (int& v : t) {
      if (renumbered[v] < 0) {
        renumbered[v] = static_cast<int>(kept.size());
        kept.push_back(mesh.positions[v]);
      }
      v = renumbered[v];
    }
  mesh.positions = std::move(kept);
}

Result<TriMesh> checked(TriMesh mesh, const std::string& name) {
  compact(mesh);
  const ManifoldReport report =
      checkManifold(mesh.triangles, static_cast<int>(mesh.positions.size()));
  if (!report.closed()) {
    Vec3 where = Vec3::Zero();
    if (report.firstBadEdge[0] >= 0) where = mesh.positions[report.firstBadEdge[0]] * 1e3;
    return usageError(
        "structure " + name,
        fmt::format("its surface does not close: {}; near ({:.1f}, {:.1f}, {:.1f}) mm",
                    report.text(), where.x(), where.y(), where.z()),
        "let each sweep start or end in x = 0, in a dome or in a window");
  }
  if (volume(mesh) < 0)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

Vec3 mirror(const Vec3& p) {
  return {-p.x(), p.y(), p.z()};
}
}  // namespace

Result<TriMesh> HalfSurface::mirrored(const std::string& name) const {
  TriMesh whole{positions_, triangles_};
  std::vector<int> twin(positions_.size());
  for (size_t i = 0; i < positions_.size(); ++i) {
    const Vec3& p = positions_[i];
    if (p.x() < 0)
      return usageError(
          "structure " + name,
          fmt::format("its left half crosses the midplane at ({:.1f}, {:.1f}, {:.1f}) mm",
                      p.x() * 1e3, p.y() * 1e3, p.z() * 1e3),
          "keep every section at x >= 0");
    twin[i] = static_cast<int>(i);
    if (p.x() == 0) continue;
    twin[i] = static_cast<int>(whole.positions.size());
    whole.positions.push_back(mirror(p));
  }
  for (const Triangle& t : triangles_)
    whole.triangles.push_back({twin[t[0]], twin[t[2]], twin[t[1]]});
  return checked(std::move(whole), name);
}

Result<std::pair<TriMesh, TriMesh>> HalfSurface::leftAndRight(const std::string& name) const {
  auto left = checked(TriMesh{positions_, triangles_}, name);
  if (!left) return std::unexpected(left.error());
  TriMesh right = *left;
  for (Vec3& p : right.positions) p = mirror(p);
  for (Triangle& t : right.triangles) std::swap(t[1], t[2]);
  return std::pair{std::move(*left), std::move(right)};
}

std::vector<int> bestTurn(const std::vector<Vec3>& border, const std::vector<Vec3>& points) {
  const int n = static_cast<int>(border.size());
  Vec3 shift = Vec3::Zero();
  for (int i = 0; i < n; ++i) shift += (border[i] - points[i]) / n;
  double best = std::numeric_limits<double>::max();
  std::vector<int> order(n), trial(n);
  for (int direction : {1, -1})
    for (int offset = 0; offset < n; ++offset) {
      double cost = 0;
      for (int i = 0; i < n; ++i) {
        trial[i] = ((offset + direction * i) % n + n) % n;
        cost += (points[trial[i]] + shift - border[i]).squaredNorm();
      }
      if (cost < best) {
        best = cost;
        order = trial;
      }
    }
  return order;
}

std::vector<Vec2> resampleClosed(const std::vector<Vec2>& control, int n) {
  const int count = static_cast<int>(control.size()), kSteps = 16;  // fine steps per control span
  std::vector<Vec2> fine;
  for (int k = 0; k < count; ++k) {
    const Vec2 &p0 = control[(k + count - 1) % count], &p1 = control[k],
               &p2 = control[(k + 1) % count], &p3 = control[(k + 2) % count];
    for (int s = 0; s < kSteps; ++s) {
      const double t = double(s) / kSteps, t2 = t * t, t3 = t2 * t;
      fine.push_back(0.5 * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t2 +
                            (3 * p1 - p0 - 3 * p2 + p3) * t3));
    }
  }
  std::vector<double> length{0};
  for (size_t i = 0; i < fine.size(); ++i)
    length.push_back(length.back() + (fine[(i + 1) % fine.size()] - fine[i]).norm());
  std::vector<Vec2> out;
  size_t at = 0;
  for (int i = 0; i < n; ++i) {
    const double target = length.back() * i / n;
    while (length[at + 1] < target) ++at;
    const double f = (target - length[at]) / (length[at + 1] - length[at]);
    out.push_back(fine[at] + f * (fine[(at + 1) % fine.size()] - fine[at]));
  }
  return out;
}

Vec3 catmullRom(const Vec3& p0, const Vec3& p1, const Vec3& p2, const Vec3& p3, double t) {
  const double t2 = t * t, t3 = t2 * t;
  return 0.5 * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t2 +
                (3 * p1 - p0 - 3 * p2 + p3) * t3);
}

std::vector<Vec2> superellipse(double exponent, int n, bool half) {
  std::vector<Vec2> out(n);
  for (int i = 0; i < n; ++i) {
    const double angle = half ? -kPi / 2 + kPi * i / (n - 1) : 2 * kPi * i / n;
    const double c = std::cos(angle), s = std::sin(angle);
    out[i] = {std::copysign(std::pow(std::abs(c), 2 / exponent), c),
              std::copysign(std::pow(std::abs(s), 2 / exponent), s)};
  }
  if (half) out.front().x() = out.back().x() = 0;  // exactly on the midplane
  return out;
}

PlanCurve::PlanCurve(const std::vector<Vec2>& control) {
  const int n = static_cast<int>(control.size()), kSteps = 20;  // fine steps per control span
  auto at = [&](int k) -> Vec3 {
    if (k < 0) return {-control[1].x(), control[1].y(), 0};  // mirrored over the midline
    const Vec2& p = control[std::min(k, n - 1)];
    return {p.x(), p.y(), 0};
  };
  for (int k = 0; k + 1 < n; ++k)
    for (int s = 0; s < kSteps; ++s)
      fine_.push_back(
          catmullRom(at(k - 1), at(k), at(k + 1), at(k + 2), double(s) / kSteps).head<2>());
  fine_.push_back(control.back());
  length_.push_back(0);
  for (size_t i = 1; i < fine_.size(); ++i)
    length_.push_back(length_.back() + (fine_[i] - fine_[i - 1]).norm());
}

std::pair<Vec2, Vec2> PlanCurve::at(double s) const {
  size_t i = 1;
  while (i + 1 < fine_.size() && length_[i] < s) ++i;
  const Vec2 along = (fine_[i] - fine_[i - 1]).normalized();
  return {fine_[i - 1] + along * (s - length_[i - 1]), along};
}

double interpolate(const std::vector<Vec2>& table, double x) {
  if (table.empty()) return 0;
  if (x <= table.front().x()) return table.front().y();
  for (size_t i = 1; i < table.size(); ++i)
    if (x <= table[i].x()) {
      const double f = (x - table[i - 1].x()) / (table[i].x() - table[i - 1].x());
      return table[i - 1].y() + f * (table[i].y() - table[i - 1].y());
    }
  return table.back().y();
}
}  // namespace swallowclip::anatomy
