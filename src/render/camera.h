// SPDX-License-Identifier: MIT
// View and projection matrices (OpenGL clip space) of a preset's view.
#pragma once
#include "render/gl.h"
#include "render/render_preset.h"

namespace swallowclip::render {

/// Axis-aligned box, metres.
struct Bounds {
  Vec3f low = Vec3f::Constant(1e9f), high = Vec3f::Constant(-1e9f);

  void add(const Vec3f& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Bounds& b) {
    low = low.cwiseMin(b.low);
    high = high.cwiseMax(b.high);
  }
  bool empty() const { return low.x() > high.x(); }
  Vec3f corner(int i) const {
    return {i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z()};
  }
};

struct Camera {
  Mat4f view, projection, viewProjection;
  Eigen::Vector4f eye;    ///< w = 1 position; w = 0 direction towards the eye
  Vec3f right, up, back;  ///< world axes of the picture; back points to the viewer
  float near_m = 0, far_m = 1;
  Eigen::Vector2f pixelsPerMetre;  ///< x: at view depth 1 m (perspective); y: constant (ortho)

  /// Picture direction (x right, y up, z to the viewer) in world axes, unit.
  Vec3f fromPicture(const Vec3f& d) const {
    return (right * d.x() + up * d.y() + back * d.z()).normalized();
  }
  /// True when the eye lies where normal . p > offset.
  bool sees(const Vec3f& normal, float offset) const;
};

/// `scene` must hold everything drawn: it sets the near and far planes.
Camera makeCamera(const ViewDef& view, int width, int height, const Bounds& scene);

Mat4f orthographic(float halfWidth, float halfHeight, float near, float far);

/// Matrix from world to shadow-map texture coordinates (0..1) for light from `direction`;
/// `radius_m` gets half the side of the square that the map covers.
Mat4f shadowMatrix(const Bounds& scene, const Vec3f& direction, float* radius_m);
}  // namespace swallowclip::render
