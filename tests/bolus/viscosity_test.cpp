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

// A particle and eight around it, which see only the first.
struct Star {
  static constexpr int n = 9, lanes = simd::kLanes;
  std::vector<float> field = std::vector<float>(12 * (n + 1)),
                     r = std::vector<float>(n * lanes, 1e18f), g[3], c = r,
                     diagonal = std::vector<float>(n);
  std::vector<int> start = std::vector<int>(n), stop = start,
                   index = std::vector<int>(n * lanes, n);
  std::vector<PairTensors> tensors = std::vector<PairTensors>(n + 1);
  ViscosityTable table;
  PairViscositySweep sweep;

  template <typename Gradient, typename Velocity>
  Star(const std::vector<Vec3>& x, const Gradient& gradientAt, const Velocity& velocityAt) {
    for (auto& of : g) of.assign(n * lanes, 0.f);
    const auto join = [&](int i, int j, int e) {
      const Vec3 d = x[i] - x[j];
      index[e] = j;
      r[e] = static_cast<float>(d.norm());
      for (int a = 0; a < 3; ++a) g[a][e] = static_cast<float>(-40 * d[a] / d.norm());
    };
    for (int i = 0; i < n; ++i) {
      Eigen::Map<Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(&field[12 * i])
          << gradientAt(x[i]).template cast<float>(),
          velocityAt(x[i]).template cast<float>();
      for (int k : {0, 1, 2}) tensors[i].even[k] = 1;
      start[i] = i * lanes, stop[i] = start[i] + lanes;
      if (i > 0) join(0, i, i - 1), join(i, 0, start[i]);
    }
    table.make(kThinning);
    sweep = {{start.data(), stop.data(), index.data(), g[0].data(), g[1].data(), g[2].data()},
             r.data(),
             tensors.data(),
             0,
             &table,
             field.data(),
             0.5f,
             0,
             0,
             0.2f,
             c.data(),
             diagonal.data(),
             false,
             nullptr};
    sweep.run(0, n);
  }
  double viscosity_Pas(int e) const { return c[e] * r[e] / 40; }
};

// v = A x + Q x x: the gradient half way between two is the mean of both.
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
  std::vector<Vec3> x(Star::n, Vec3::Zero());
  for (int i = 1; i < Star::n; ++i) x[i] = 2e-3 * vector();
  Star star(x, gradientAt, velocityAt);
  double least = INFINITY, most = 0;
  for (int i = 1; i < Star::n; ++i) {
    const double mu = apparentViscosity_Pas(kThinning, shearRate_s(gradientAt((x[0] + x[i]) / 2)));
    EXPECT_NEAR(star.viscosity_Pas(i - 1), mu, 2e-3 * mu) << i;
    EXPECT_EQ(star.c[i - 1], star.c[star.start[i]]) << "not what the other has";
    least = std::min(least, mu), most = std::max(most, mu);
  }
  EXPECT_GT(most, 1.1 * least);  // they do differ
  // what is no number is found where velocities are looked at, and does no harm here
  for (const float bad : {NAN, INFINITY, 1e30f}) {
    star.field[12 + 3] = bad;
    star.sweep.run(0, Star::n);
    EXPECT_TRUE(std::isfinite(star.c[0])) << bad;
  }
  star.sweep.constant = 0.7f;
  star.sweep.run(0, Star::n);
  EXPECT_NEAR(star.viscosity_Pas(0), 0.7, 1e-6);
}

// Shear that bends more on one side, as beside a plug: neither the difference of the velocities nor
// the mean of the slopes is what is there half way.
TEST(Viscosity, PairsAlongTheGradientSeeItsCurvature) {
  const double bend_m2s = 3e7;  // v_x = bend z^3
  std::vector<Vec3> x(Star::n, Vec3(0, 0, 1e-3));
  for (int i = 1; i < Star::n; ++i) x[i].z() += (i - 3.5) * 4e-4;
  const Star star(
      x,
      [&](const Vec3& at) {
        Mat3 g = Mat3::Zero();
        g(0, 2) = 3 * bend_m2s * at.z() * at.z();
        return g;
      },
      [&](const Vec3& at) { return Vec3(bend_m2s * std::pow(at.z(), 3), 0, 0); });
  for (int i = 1; i < Star::n; ++i) {
    const double middle = (x[0].z() + x[i].z()) / 2;
    const double mu = apparentViscosity_Pas(kThinning, 3 * bend_m2s * middle * middle);
    EXPECT_NEAR(star.viscosity_Pas(i - 1), mu, 2e-3 * mu) << i;
  }
}
}  // namespace
}  // namespace swallowclip::bolus
