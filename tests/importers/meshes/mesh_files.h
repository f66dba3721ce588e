// Mesh files in memory: written and read for a test.
#pragma once

#include <fmt/core.h>

#include <bit>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "geometry/mesh.h"
#include "geometry/mesh/check.h"
#include "importers/import.h"

namespace panwright::importers {

// Result of a reading, with its diagnostics.
struct MeshReading {
  std::vector<MemoryFile> files;  // the log shows their text
  DiagnosticLog log{1000};
  std::optional<Imported> out;

  const scene::Scene& scene() const { return out->scene; }
  const geometry::Mesh& mesh(std::size_t i = 0) const {
    return *std::get<geometry::MeshShape>(scene().shapes.at(i));
  }
  // "root/a/b" of an instance's node
  std::string path(std::size_t i) const {
    std::string path;
    for (std::int32_t n = scene().instances.at(i).node; n > 0;
         n = scene().nodes[static_cast<std::size_t>(n)].parent)
      path = "/" + scene().nodes[static_cast<std::size_t>(n)].name + path;
    return path;
  }
  const materials::Material& material(std::size_t i) const {
    return scene().materials.at(static_cast<std::size_t>(scene().instances.at(i).material));
  }
  // "line:column CODE" of errors and warnings, in order of report
  std::vector<std::string> places() const {
    std::vector<std::string> out_list;
    for (const Diagnostic& entry : log.entries()) {
      if (entry.severity() == Severity::note) continue;
      const Position p = log.sources().position(entry.where.file, entry.where.begin);
      out_list.push_back(fmt::format("{}:{} {}", p.line, p.column, code_info(entry.code).name));
    }
    return out_list;
  }
  std::string text() const { return to_text(log); }
};

inline std::unique_ptr<MeshReading> read_meshes(std::vector<MemoryFile> files,
                                                const Options& options = {}) {
  auto out = std::make_unique<MeshReading>();
  out->files = std::move(files);
  auto result = import_memory(out->files, options, out->log);
  if (result) out->out = std::move(*result);
  return out;
}

// Faces of any size over a list of points.
struct Polyhedron {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
};

// x, y, z from −1 to 1, six squares.
inline Polyhedron cube() {
  Polyhedron out;
  for (int i = 0; i < 8; ++i)
    out.points.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
  out.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return out;
}

// Rings of a unit sphere about z; triangles at the poles, quads between.
inline Polyhedron ball(std::uint32_t rings, std::uint32_t around) {
  Polyhedron out;
  out.points.push_back({0, 0, 1});
  for (std::uint32_t i = 1; i < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double t = kPi * i / rings, p = 2 * kPi * j / around;
      out.points.push_back({std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)});
    }
  out.points.push_back({0, 0, -1});
  const auto last = static_cast<std::uint32_t>(out.points.size() - 1);
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return 1 + (i - 1) * around + j % around;
  };
  for (std::uint32_t j = 0; j < around; ++j) {
    out.faces.push_back({0, at(1, j), at(1, j + 1)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i)
      out.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    out.faces.push_back({last, at(rings - 1, j + 1), at(rings - 1, j)});
  }
  return out;
}

inline std::string numbers(const Vec3& p) {
  return format_double(p.x) + " " + format_double(p.y) + " " + format_double(p.z);
}

inline std::string obj_of(const Polyhedron& in) {
  std::string out;
  for (const Vec3& p : in.points) out += "v " + numbers(p) + "\n";
  for (const auto& face : in.faces) {
    out += "f";
    for (const std::uint32_t v : face) out += fmt::format(" {}", v + 1);
    out += "\n";
  }
  return out;
}

template <class T>
void append_bytes(std::string& out, T value, bool big = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (std::size_t k = 0; k < sizeof(T); ++k) out += bytes[big ? sizeof(T) - 1 - k : k];
}

inline std::string stl_text_of(const Polyhedron& in, const std::string& name = "part") {
  std::string out = "solid " + name + "\n";
  for (const auto& face : in.faces) {
    out += " facet normal 0 0 0\n  outer loop\n";
    for (const std::uint32_t v : face) out += "   vertex " + numbers(in.points[v]) + "\n";
    out += "  endloop\n endfacet\n";
  }
  return out + "endsolid " + name + "\n";
}

// Triangles only.
inline std::string stl_binary_of(const Polyhedron& in, std::string header = "made for a test") {
  header.resize(80, ' ');
  std::string out = header;
  append_bytes(out, static_cast<std::uint32_t>(in.faces.size()));
  for (const auto& face : in.faces) {
    for (int k = 0; k < 3; ++k) append_bytes(out, 0.0f);
    for (const std::uint32_t v : face)
      for (int k = 0; k < 3; ++k) append_bytes(out, static_cast<float>(in.points[v][k]));
    append_bytes(out, std::uint16_t{0});
  }
  return out;
}

enum class Order { text, little, big };

inline std::string ply_of(const Polyhedron& in, Order order) {
  const char* const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  std::string out = fmt::format(
      "ply\nformat {} 1.0\ncomment made for a test\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      names[static_cast<int>(order)], in.points.size(), in.faces.size());
  const bool big = order == Order::big;
  for (const Vec3& p : in.points) {
    if (order == Order::text) {
      out += numbers(p) + "\n";
      continue;
    }
    for (int k = 0; k < 3; ++k) append_bytes(out, p[k], big);
  }
  for (const auto& face : in.faces) {
    if (order == Order::text) {
      out += fmt::format("{}", face.size());
      for (const std::uint32_t v : face) out += fmt::format(" {}", v);
      out += "\n";
      continue;
    }
    append_bytes(out, static_cast<std::uint8_t>(face.size()), big);
    for (const std::uint32_t v : face) append_bytes(out, static_cast<std::int32_t>(v), big);
  }
  return out;
}

inline std::size_t node_index(const scene::Scene& scene, std::string_view name) {
  for (std::size_t i = 0; i < scene.nodes.size(); ++i)
    if (scene.nodes[i].name == name) return i;
  return scene.nodes.size();
}

inline scene::Joint* joint_named(scene::Scene& scene, std::string_view name) {
  for (scene::Joint& joint : scene.joints)
    if (joint.name == name) return &joint;
  return nullptr;
}

}  // namespace panwright::importers
