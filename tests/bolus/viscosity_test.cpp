// SPDX-License-Identifier: MIT
#include "bolus/viscosity.h"

#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "bolus/velocity_gradient.h"
#include "core/simd.h"

namespace swallowclip::bolus {
namespace {
// v_x = a z + b z^2 / 2 over a wall at z = 0, seen from z = d: half way the slope is a + b d / 2.
TEST(Viscosity, ShearHalfWayToTheWall) {
  const double a = 3, b = -400, d = 4e-4, weight = 250;
  WallSample w;
  w.gradLambda = {0, 0, -weight};
  w.area = weight;
  w.friction = weight / d;
  Mat3 gradient = Mat3::Zero();
  gradient(0, 2) = a + b * d;
  gradient(1, 0) = 0.7;  // along the wall nothing changes
  Mat3 expected = gradient;
  expected(0, 2) = a + b * d / 2;
  const Vec3 v(a * d + b * d * d / 2, 0, 0);
  const Mat3 halfWay = gradientBeforeWall_s(w, v, gradient);
  EXPECT_LT((halfWay - expected).norm(), 1e-12 * a) << halfWay;
  // and a wall that moves with the fluid takes its motion off
  const Vec3 wall(0.1, -0.2, 0);
  w.frictionVelocity = w.friction * wall;
  EXPECT_LT((gradientBeforeWall_s(w, v + wall, gradient) - expected).norm(), 1e-12 * a);
  EXPECT_EQ(gradientBeforeWall_s({}, v, gradient), gradient);  // no wall within reach
}

const Fluid kThinning{.model = RheologyModel::powerLaw, .consistency_Pasn = 3, .index = 0.4};
const Fluid kCarreau{.model = RheologyModel::carreau, .index = 0.3, .eta0_Pas = 2};
const Fluid kYielding{.model = RheologyModel::herschelBulkley,
                      .consistency_Pasn = 0.5,
                      .yield_Pa = 5,
                      .maxViscosity_Pas = 1e4};

double tabled_Pas(const ViscosityTable& t, double rate_s) {
  const float square = static_cast<float>(rate_s * rate_s);
  const int word = std::bit_cast<int>(square);
  const auto& node = t.nodes.at((word >> t.kPartBits) - t.first);
  const float from = std::bit_cast<float>((word >> t.kPartBits) << t.kPartBits),
              to = std::bit_cast<float>(((word >> t.kPartBits) + 1) << t.kPartBits);
  return node.value_Pas + (square - from) / (to - from) * node.step_Pas;
}

TEST(Viscosity, TableFollowsTheLaws) {
  ViscosityTable table;
  for (const Fluid& fluid : {kThinning, kCarreau, kYielding}) {
    table.make(fluid);
    for (double rate = 2e-3; rate < 9e5; rate *= 1.07) {
      const double wanted = apparentViscosity_Pas(fluid, rate);
      EXPECT_NEAR(tabled_Pas(table, rate), wanted, 1e-3 * wanted) << rate;
    }
  }
}

// v = A x + Q x x: the gradient half way between two is what F and (v_i - v_j) / r give there.
TEST(Viscosity, PairsRubWithTheViscosityHalfWay) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto vector = [&] { return Vec3(any(random), any(random), any(random)); };
  Mat3 A, Q[3];
  for (int a = 0; a < 3; ++a) {
    A.row(a) = 20 * vector();
    const Vec3 p = vector(), q = vector();
    Q[a] = 3e4 * (p * q.transpose() + q * p.transpose());
  }
  const auto gradientAt = [&](const Vec3& x) {
    Mat3 g = A;
    for (int a = 0; a < 3; ++a) g.row(a) += (Q[a] * x).transpose();
    return g;
  };
  const auto velocityAt = [&](const Vec3& x) {
    Vec3 v = A * x;
    for (int a = 0; a < 3; ++a) v[a] += x.dot(Q[a] * x) / 2;
    return v;
  };
  // 0 and 1 to 8 around it; the lists of those have only 0, and padding
  constexpr int n = 9, lanes = simd::kLanes;
  std::vector<Vec3> x(n, Vec3::Zero());
  for (int i = 1; i < n; ++i) x[i] = 2e-3 * vector();
  std::vector<float> field(12 * (n + 1)), evenness(8 * (n + 1)), r(n * lanes, 1e18f);
  std::vector<float> g[3], c(n * lanes), diagonal(n);
  for (auto& of : g) of.assign(n * lanes, 0.f);
  std::vector<int> start(n), stop(n), index(n * lanes, n);
  const auto join = [&](int i, int j, int e) {
    const Vec3 d = x[i] - x[j];
    index[e] = j;
    r[e] = static_cast<float>(d.norm());
    for (int a = 0; a < 3; ++a) g[a][e] = static_cast<float>(-40 * d[a] / d.norm());
  };
  for (int i = 0; i < n; ++i) {
    Eigen::Map<Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(&field[12 * i])
        << gradientAt(x[i]).cast<float>(),
        velocityAt(x[i]).cast<float>();
    for (int k : {0, 1, 2}) evenness[8 * i + k] = 1;
    start[i] = i * lanes, stop[i] = start[i] + lanes;
    if (i > 0) join(0, i, i - 1), join(i, 0, start[i]);
  }
  ViscosityTable table;
  table.make(kThinning);
  PairViscositySweep sweep{
      {start.data(), stop.data(), index.data(), g[0].data(), g[1].data(), g[2].data()},
      r.data(),
      evenness.data(),
      0,
      &table,
      field.data(),
      0.5f,
      0,
      0,
      0.2f,
      c.data(),
      diagonal.data(),
      nullptr,
      nullptr};
  sweep.run(0, n);
  double least = INFINITY, most = 0;
  for (int i = 1; i < n; ++i) {
    const double mu = apparentViscosity_Pas(kThinning, shearRate_s(gradientAt((x[0] + x[i]) / 2)));
    EXPECT_NEAR(c[i - 1] * r[i - 1] / 40, mu, 2e-3 * mu) << i;
    EXPECT_EQ(c[i - 1], c[start[i]]) << "not what the other has";
    least = std::min(least, mu), most = std::max(most, mu);
  }
  EXPECT_GT(most, 1.1 * least);  // they do differ
  // what is no number is found where velocities are looked at, and does no harm here
  for (const float bad : {NAN, INFINITY, 1e30f}) {
    field[12 + 3] = bad;
    sweep.run(0, n);
    EXPECT_TRUE(std::isfinite(c[0])) << bad;
  }
  sweep.constant = 0.7f;
  sweep.run(0, n);
  EXPECT_NEAR(c[0] * r[0] / 40, 0.7, 1e-6);
}
}  // namespace
}  // namespace swallowclip::bolus
