// SPDX-License-Identifier: MIT
#include "render/colour_vision.h"

#include <cmath>

namespace swallowclip::render {
namespace {

Eigen::Matrix3f machado(Vision v) {
  Eigen::Matrix3f m = Eigen::Matrix3f::Identity();
  if (v == Vision::protan)
    m << 0.152286f, 1.052583f, -0.204868f, 0.114503f, 0.786281f, 0.099216f, -0.003882f, -0.048116f,
        1.051998f;
  if (v == Vision::deutan)
    m << 0.367322f, 0.860646f, -0.227968f, 0.280085f, 0.672501f, 0.047413f, -0.011820f, 0.042940f,
        0.968881f;
  if (v == Vision::tritan)
    m << 1.255528f, -0.076749f, -0.178779f, -0.078411f, 0.930809f, 0.147602f, 0.004733f, 0.691367f,
        0.303900f;
  return m;
}

Vec3 lab(const Colour& srgb) {
  Eigen::Matrix3d xyzFromRgb;  // IEC 61966-2-1
  xyzFromRgb << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339,
      0.1191920, 0.9503041;
  const Vec3 white(0.95047, 1.0, 1.08883);  // D65, 2 degrees
  const Vec3 f =
      (xyzFromRgb * linear(srgb).cast<double>()).cwiseQuotient(white).unaryExpr([](double t) {
        constexpr double kKnee = 6.0 / 29;
        return t > kKnee * kKnee * kKnee ? std::cbrt(t) : t / (3 * kKnee * kKnee) + 4.0 / 29;
      });
  return {116 * f.y() - 16, 500 * (f.x() - f.y()), 200 * (f.y() - f.z())};
}

double hue_rad(double b, double a) {
  if (a == 0 && b == 0) return 0;
  const double h = std::atan2(b, a);
  return h < 0 ? h + 2 * kPi : h;
}
}  // namespace

const char* name(Vision vision) {
  switch (vision) {
    case Vision::protan:
      return "protan";
    case Vision::deutan:
      return "deutan";
    case Vision::tritan:
      return "tritan";
    case Vision::normal:
      break;
  }
  return "normal";
}

Vec3f linear(const Colour& srgb) {
  return srgb.unaryExpr(
      [](float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); });
}

float toSrgb(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

Colour seenBy(Vision vision, const Colour& srgb) {
  if (vision == Vision::normal) return srgb;
  const Vec3f seen = (machado(vision) * linear(srgb)).cwiseMax(0.0f).cwiseMin(1.0f);
  return seen.unaryExpr([](float c) { return toSrgb(c); });
}

double colourDifference(const Colour& a_srgb, const Colour& b_srgb) {
  return ciede2000(lab(a_srgb), lab(b_srgb));
}

// Symbols and equation numbers as in Sharma, Wu & Dalal 2005; kL = kC = kH = 1.
double ciede2000(const Vec3& lab1, const Vec3& lab2) {
  const auto pow7 = [](double x) { return std::pow(x, 7); };
  const double cMean =
      0.5 * (std::hypot(lab1.y(), lab1.z()) + std::hypot(lab2.y(), lab2.z()));     // (3)
  const double g = 0.5 * (1 - std::sqrt(pow7(cMean) / (pow7(cMean) + pow7(25))));  // (4)
  const double a1 = (1 + g) * lab1.y(), a2 = (1 + g) * lab2.y();                   // (5)
  const double c1 = std::hypot(a1, lab1.z()), c2 = std::hypot(a2, lab2.z());       // (6)
  const double h1 = hue_rad(lab1.z(), a1), h2 = hue_rad(lab2.z(), a2);             // (7)
  const double dL = lab2.x() - lab1.x(), dC = c2 - c1;                             // (8, 9)
  double dh = c1 * c2 == 0 ? 0 : h2 - h1;                                          // (10)
  if (dh > kPi) dh -= 2 * kPi;
  if (dh < -kPi) dh += 2 * kPi;
  const double dH = 2 * std::sqrt(c1 * c2) * std::sin(dh / 2);        // (11)
  const double l = 0.5 * (lab1.x() + lab2.x()), c = 0.5 * (c1 + c2);  // (12, 13)
  double h = h1 + h2;                                                 // (14)
  if (c1 * c2 != 0) {
    if (std::abs(h1 - h2) > kPi) h += h < 2 * kPi ? 2 * kPi : -2 * kPi;
    h /= 2;
  }
  const double deg = kPi / 180;
  const double t = 1 - 0.17 * std::cos(h - 30 * deg) + 0.24 * std::cos(2 * h) +
                   0.32 * std::cos(3 * h + 6 * deg) - 0.20 * std::cos(4 * h - 63 * deg);  // (15)
  const double turn = (h / deg - 275) / 25;
  const double dTheta = 30 * deg * std::exp(-turn * turn);          // (16)
  const double rC = 2 * std::sqrt(pow7(c) / (pow7(c) + pow7(25)));  // (17)
  const double l50 = (l - 50) * (l - 50);
  const double sL = 1 + 0.015 * l50 / std::sqrt(20 + l50), sC = 1 + 0.045 * c;  // (18, 19)
  const double sH = 1 + 0.015 * c * t, rT = -std::sin(2 * dTheta) * rC;         // (20, 21)
  const double x = dL / sL, y = dC / sC, z = dH / sH;
  return std::sqrt(x * x + y * y + z * z + rT * y * z);  // (22)
}
}  // namespace swallowclip::render
