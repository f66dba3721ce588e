// Assemblies with known hidden geometry.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace panwright::compiler::assemblies {

inline constexpr char kEither = 2;  // visible through a negligible gap

// Scene, with the visibility of each triangle of each instance from outside.
struct Assembly {
  std::string name;
  scene::Scene scene;
  std::vector<std::vector<char>> visible;  // instances, triangles
  std::uint64_t hidden() const {
    std::uint64_t count = 0;
    for (const auto& list : visible)
      for (const char one : list) count += one == 0;
    return count;
  }
};

class Builder {
 public:
  explicit Builder(std::string name) {
    out_.name = std::move(name);
    out_.scene.nodes.emplace_back();
    out_.scene.nodes[0].name = "root";
    out_.scene.materials.emplace_back();
  }

  std::int32_t add_mesh(geometry::Mesh mesh) {
    out_.scene.shapes.push_back(std::make_shared<const geometry::Mesh>(std::move(mesh)));
    return static_cast<std::int32_t>(out_.scene.shapes.size() - 1);
  }

  std::int32_t add_node(const Vec3& at, std::int32_t parent = 0) {
    scene::Node node;
    node.name = "part" + std::to_string(out_.scene.nodes.size());
    node.parent = parent;
    node.parent_from_node.translation = at;
    out_.scene.nodes.push_back(node);
    return static_cast<std::int32_t>(out_.scene.nodes.size() - 1);
  }

  // visible: of each triangle
  void add(std::int32_t shape, const Vec3& at, std::vector<char> visible) {
    scene::Instance instance;
    instance.node = add_node(at);
    instance.shape = shape;
    out_.scene.instances.push_back(instance);
    out_.visible.push_back(std::move(visible));
  }
  void add(std::int32_t shape, const Vec3& at, bool visible) {
    const auto& mesh =
        *std::get<geometry::MeshShape>(out_.scene.shapes[static_cast<std::size_t>(shape)]);
    add(shape, at, std::vector<char>(mesh.triangles.size(), visible));
  }

  Assembly done() { return std::move(out_); }

 private:
  Assembly out_;
};

inline void add_quad(geometry::Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c,
                     const Vec3& d) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
  mesh.triangles.push_back({base, base + 1, base + 2});
  mesh.triangles.push_back({base, base + 2, base + 3});
}

// A block about the origin, each face of n x n squares.
inline geometry::Mesh block(const Vec3& size, std::uint32_t n) {
  geometry::Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 right(0);
      Vec3 up(0);
      Vec3 normal(0);
      right[(axis + 1) % 3] = side;
      up[(axis + 2) % 3] = 1;
      normal[axis] = side;
      const auto point = [&](std::uint32_t i, std::uint32_t j) {
        return 0.5 * size * (normal + (2.0 * i / n - 1) * right + (2.0 * j / n - 1) * up);
      };
      for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i)
          add_quad(mesh, point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
    }
  }
  mesh.closed = true;
  return mesh;
}

// Boxes one in another: only the outermost is visible.
inline Assembly nested_boxes(std::uint32_t boxes, std::uint32_t n) {
  Builder builder("nested boxes");
  for (std::uint32_t i = 0; i < boxes; ++i)
    builder.add(builder.add_mesh(block(Vec3(2, 1.5, 1) * (1 - 0.9 * i / boxes), n)), Vec3(0),
                i == 0);
  return builder.done();
}

// Points of a circle in a plane across z.
inline Vec3 on_circle(double radius, std::uint32_t i, std::uint32_t n, double z) {
  const double a = 2 * kPi * i / n;
  return {radius * std::cos(a), radius * std::sin(a), z};
}

// Cylinder about z in rings of quads, with caps of fans, and its ranges of triangles.
struct Round {
  geometry::Mesh mesh;
  std::uint32_t side_end = 0;    // triangles of the side come first
  std::uint32_t bottom_end = 0;  // then those of the bottom, then the top
};
inline Round round_bar(double radius, double bottom, double top, std::uint32_t n,
                       std::uint32_t rings) {
  Round out;
  geometry::Mesh& mesh = out.mesh;
  for (std::uint32_t j = 0; j < rings; ++j) {
    const double low = bottom + (top - bottom) * j / rings;
    const double high = bottom + (top - bottom) * (j + 1) / rings;
    for (std::uint32_t i = 0; i < n; ++i)
      add_quad(mesh, on_circle(radius, i, n, low), on_circle(radius, (i + 1) % n, n, low),
               on_circle(radius, (i + 1) % n, n, high), on_circle(radius, i, n, high));
  }
  out.side_end = static_cast<std::uint32_t>(mesh.triangles.size());
  for (const double z : {bottom, top}) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto base = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back({0, 0, z});
      mesh.positions.push_back(on_circle(radius, z == top ? i : (i + 1) % n, n, z));
      mesh.positions.push_back(on_circle(radius, z == top ? (i + 1) % n : i, n, z));
      mesh.triangles.push_back({base, base + 1, base + 2});
    }
    if (z == bottom) out.bottom_end = static_cast<std::uint32_t>(mesh.triangles.size());
  }
  mesh.closed = true;
  return out;
}

// A plate with a round hole through it, of n facets: square outside of half size `half`.
inline geometry::Mesh drilled_plate(double half, double radius, double bottom, double top,
                                    std::uint32_t n) {
  geometry::Mesh mesh;
  const auto outside = [&](std::uint32_t i, double z) {
    const Vec3 p = on_circle(1, i, n, z);
    const double scale = half / std::fmax(std::fabs(p.x), std::fabs(p.y));
    return Vec3(p.x * scale, p.y * scale, z);
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    add_quad(mesh, on_circle(radius, i, n, top), outside(i, top), outside(next, top),
             on_circle(radius, next, n, top));
    add_quad(mesh, on_circle(radius, next, n, bottom), outside(next, bottom), outside(i, bottom),
             on_circle(radius, i, n, bottom));
    add_quad(mesh, outside(i, bottom), outside(next, bottom), outside(next, top), outside(i, top));
    // the bore
    add_quad(mesh, on_circle(radius, next, n, bottom), on_circle(radius, i, n, bottom),
             on_circle(radius, i, n, top), on_circle(radius, next, n, top));
  }
  mesh.closed = true;
  return mesh;
}

// Plates on bases, with bolts in blind bores: the heads are visible; the shanks, the bores and
// contact faces are not. Equal parts share a mesh.
inline Assembly bolts_in_holes(std::uint32_t side, std::uint32_t n, std::uint32_t rings) {
  Builder builder("bolts in holes");
  constexpr double kPitch = 0.1;
  constexpr double kRadius = 0.01;
  constexpr double kDepth = 0.03;
  constexpr std::uint32_t kSquares = 4;
  const std::int32_t plate = builder.add_mesh(drilled_plate(kPitch / 2, kRadius, -kDepth, 0, n));
  // top, bottom, side and bore of each facet in turn
  std::vector<char> plate_visible;
  for (std::uint32_t i = 0; i < n; ++i)
    for (const char seen : {1, 0, 1, 0}) plate_visible.insert(plate_visible.end(), 2, seen);
  const std::int32_t base = builder.add_mesh(block({kPitch, kPitch, 0.01}, kSquares));
  // its top is the last face
  std::vector<char> base_visible(12 * kSquares * kSquares, 1);
  std::fill(base_visible.end() - 2 * kSquares * kSquares, base_visible.end(), 0);
  const std::int32_t shank = builder.add_mesh(round_bar(kRadius, -kDepth, 0, n, rings).mesh);
  const Round top = round_bar(2 * kRadius, 0, kRadius, n, 1);
  std::vector<char> head_visible(top.mesh.triangles.size(), 1);
  for (std::uint32_t i = top.side_end; i < top.bottom_end; ++i) head_visible[i] = 0;
  const std::int32_t head = builder.add_mesh(top.mesh);
  for (std::uint32_t j = 0; j < side; ++j) {
    for (std::uint32_t i = 0; i < side; ++i) {
      // apart, so that the sides of plates are visible
      const Vec3 at(1.5 * kPitch * i, 1.5 * kPitch * j, 0);
      builder.add(plate, at, plate_visible);
      builder.add(base, at - Vec3(0, 0, kDepth + 0.005), base_visible);
      builder.add(shank, at, false);
      builder.add(head, at, head_visible);
    }
  }
  return builder.done();
}

// A box with a round hole in its top, and a round tank in it. A facet of the tank is visible if
// some point of the hole lies above its plane: the tank is convex, and nothing else occludes.
inline Assembly tank_in_a_bus(std::uint32_t n, double hole) {
  Builder builder("tank in a bus");
  constexpr double kHalf = 0.5;
  constexpr std::uint32_t kFacets = 32;  // of the hole
  // metres that the hole rises above a facet's plane: facets visible through less than 2e-3 of the
  // hole, edge on, may be found or not (7.6e-5 measured among those not found)
  const double kSliver = 2e-3 * hole;
  geometry::Mesh bus = block(Vec3(2 * kHalf), 8);
  bus.triangles.resize(bus.triangles.size() - 2 * 8 * 8);  // its top
  const geometry::Mesh lid = drilled_plate(kHalf, hole, kHalf, kHalf, kFacets);
  for (std::uint32_t i = 0; i < kFacets; ++i) {
    const auto first = static_cast<std::uint32_t>(bus.positions.size());
    for (std::uint32_t k = 0; k < 4; ++k) bus.positions.push_back(lid.positions[16 * i + k]);
    bus.triangles.push_back({first, first + 1, first + 2});
    bus.triangles.push_back({first, first + 2, first + 3});
  }
  bus.closed = false;
  builder.add(builder.add_mesh(bus), Vec3(0), true);
  geometry::Mesh tank;
  const auto point = [&](std::uint32_t i, std::uint32_t j) {
    const double b = kPi * j / n;
    return Vec3(0.05, 0, 0) + 0.4 * on_circle(std::sin(b), i % (2 * n), 2 * n, std::cos(b));
  };
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < 2 * n; ++i) {
      const auto first = static_cast<std::uint32_t>(tank.positions.size());
      tank.positions.insert(tank.positions.end(),
                            {point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)});
      if (j + 1 < n) tank.triangles.push_back({first, first + 1, first + 2});
      if (j > 0) tank.triangles.push_back({first, first + 2, first + 3});
    }
  tank.closed = true;
  std::vector<char> visible;
  for (const geometry::Triangle& t : tank.triangles) {
    const Vec3& a = tank.positions[t[0]];
    const Vec3 normal =
        glm::normalize(glm::cross(tank.positions[t[1]] - a, tank.positions[t[2]] - a));
    double above = -1;
    for (std::uint32_t i = 0; i < kFacets; ++i)
      above = std::fmax(above, glm::dot(normal, on_circle(hole, i, kFacets, kHalf) - a));
    visible.push_back(above > kSliver ? 1 : above > 0 ? kEither : 0);
  }
  builder.add(builder.add_mesh(tank), Vec3(0), visible);
  return builder.done();
}

}  // namespace panwright::compiler::assemblies
