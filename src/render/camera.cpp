// SPDX-License-Identifier: MIT
#include "render/camera.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::render {
namespace {

Mat4f viewMatrix(const Vec3f& right, const Vec3f& up, const Vec3f& back, const Vec3f& eye) {
  Mat4f m = Mat4f::Identity();
  m.block<1, 3>(0, 0) = right.transpose();
  m.block<1, 3>(1, 0) = up.transpose();
  m.block<1, 3>(2, 0) = back.transpose();
  m.block<3, 1>(0, 3) = -(m.block<3, 3>(0, 0) * eye);
  return m;
}

Mat4f perspective(float tanHalfY, float aspect, float near, float far) {
  Mat4f m = Mat4f::Zero();
  m(0, 0) = 1 / (tanHalfY * aspect);
  m(1, 1) = 1 / tanHalfY;
  m(2, 2) = -(far + near) / (far - near);
  m(2, 3) = -2 * far * near / (far - near);
  m(3, 2) = -1;
  return m;
}
}  // namespace

Mat4f orthographic(float halfWidth, float halfHeight, float near, float far) {
  Mat4f m = Mat4f::Identity();
  m(0, 0) = 1 / halfWidth;
  m(1, 1) = 1 / halfHeight;
  m(2, 2) = -2 / (far - near);
  m(2, 3) = -(far + near) / (far - near);
  return m;
}

bool Camera::sees(const Vec3f& normal, float offset) const {
  return normal.dot(eye.head<3>()) > (eye.w() > 0.5f ? offset : 0.0f);
}

Camera makeCamera(const ViewDef& view, int width, int height, const Bounds& scene) {
  Camera c;
  const Vec3f eye = view.eye_m.cast<float>();
  c.back = (view.eye_m - view.target_m).normalized().cast<float>();
  c.right = view.up.cast<float>().cross(c.back).normalized();
  c.up = c.back.cross(c.right);
  c.view = viewMatrix(c.right, c.up, c.back, eye);
  float near = 1e9f, far = 1e-3f;
  for (int i = 0; i < 8; ++i) {
    const float depth = -(c.back.dot(scene.corner(i) - eye));
    near = std::min(near, depth);
    far = std::max(far, depth);
  }
  const bool perspectiveView = view.projection == Projection::perspective;
  const float margin = 2e-3f;  // keeps outlines and caps off the planes
  c.near_m = perspectiveView ? std::max(near - margin, 0.01f) : near - margin;
  c.far_m = std::max(far + margin, c.near_m + 0.01f);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  if (perspectiveView) {
    const float t = static_cast<float>(std::tan(view.fovY_rad / 2));
    c.projection = perspective(t, aspect, c.near_m, c.far_m);
    c.eye = {eye.x(), eye.y(), eye.z(), 1.0f};
    c.pixelsPerMetre = {static_cast<float>(height) / (2 * t), 0.0f};
  } else {
    const float half = static_cast<float>(view.orthoHeight_m / 2);
    c.projection = orthographic(half * aspect, half, c.near_m, c.far_m);
    c.eye = {c.back.x(), c.back.y(), c.back.z(), 0.0f};
    c.pixelsPerMetre = {0.0f, static_cast<float>(height) / (2 * half)};
  }
  c.viewProjection = c.projection * c.view;
  return c;
}

Mat4f shadowMatrix(const Bounds& scene, const Vec3f& direction, float* radius_m) {
  const Vec3f back = direction.normalized();
  const Vec3f any = std::abs(back.z()) < 0.9f ? Vec3f(0, 0, 1) : Vec3f(0, 1, 0);
  const Vec3f right = any.cross(back).normalized();
  const Vec3f centre = 0.5f * (scene.low + scene.high);
  const float radius = 0.5f * (scene.high - scene.low).norm() + 1e-3f;
  *radius_m = radius;
  const Mat4f view = viewMatrix(right, back.cross(right), back, centre);
  Mat4f half = Mat4f::Identity();  // clip -1..1 to texture 0..1
  half.diagonal() << 0.5f, 0.5f, 0.5f, 1.0f;
  half.block<3, 1>(0, 3).setConstant(0.5f);
  return half * orthographic(radius, radius, -radius, radius) * view;
}
}  // namespace swallowclip::render
