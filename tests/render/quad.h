#pragma once
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "render/job.h"
#include "visual/normals.h"

namespace mortise::render::test {

// A square of edge 2 in the plane y = 0, seen from -y: x to the right, z up, texture upright.
inline DrawMesh quad() {
  DrawMesh m;
  m.points = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  m.normals.assign(4, Vec3(0, -1, 0));
  m.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  m.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  return m;
}

inline DrawMesh ball(const Vec3& centre, double radius) {
  const geometry::TriMesh surface = geometry::surface_of(geometry::sphere(radius, radius / 12));
  DrawMesh m;
  for (const Vec3& p : surface.points) {
    m.points.push_back(centre + p);
    m.normals.push_back(p.normalized());
  }
  m.triangles = surface.triangles;
  return m;
}

// Looks along +y from (0, -distance, 0), 200 x 120 pixels.
inline RenderJob job_from(double distance) {
  RenderJob job;
  job.width = 200, job.height = 120;
  job.camera.position = {0, -distance, 0};
  job.camera.fov = 0.6;
  return job;
}

struct Blob {
  double x = 0, y = 0;  // centroid [pixels]; pixel (0, 0) has its middle at (0.5, 0.5)
  int pixels = 0;
};

// Pixels where two pictures differ.
inline Blob difference(const Image& a, const Image& b) {
  Blob blob;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      int most = 0;
      for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(int(a.at(x, y)[c]) - int(b.at(x, y)[c])));
      if (most < 8) continue;
      blob.x += x + 0.5, blob.y += y + 0.5, ++blob.pixels;
    }
  if (blob.pixels > 0) blob.x /= blob.pixels, blob.y /= blob.pixels;
  return blob;
}

}  // namespace mortise::render::test
