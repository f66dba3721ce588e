#include "bench/cad_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

namespace panwright::bench {

namespace {

// the band reaches from this polar angle to its mirror image
constexpr double kTop = 0.1 * kPi;

void append_number(std::string& out, double value) {
  char text[32];
  const int length = std::snprintf(text, sizeof text, "%.6f", value);
  out.append(text, static_cast<std::size_t>(length));
}

template <class T>
void append(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

Vec3 Band::at(std::uint32_t around, std::uint32_t along) const {
  const double u = 2 * kPi * (around % side_) / side_;
  const double v = kTop + (kPi - 2 * kTop) * along / side_;
  const Vec3 p(std::sin(v) * std::cos(u), std::cos(v), -std::sin(v) * std::sin(u));
  return {std::round(p.x * 1e6) / 1e6, std::round(p.y * 1e6) / 1e6, std::round(p.z * 1e6) / 1e6};
}

double Band::off(const Vec3& p) const {
  double u = std::atan2(-p.z, p.x);
  if (u < 0) u += 2 * kPi;
  const double v = std::acos(std::clamp(p.y, -1.0, 1.0));
  const double i = std::round(u / (2 * kPi) * side_);
  const double j = std::round((v - kTop) / (kPi - 2 * kTop) * side_);
  if (!(j >= 0 && j <= side_)) return std::numeric_limits<double>::infinity();
  return glm::length(p - at(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)));
}

std::string Band::vrml() const {
  std::string out =
      "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { creaseAngle 1\n"
      "coord Coordinate { point [\n";
  for (std::uint32_t j = 0; j <= side_; ++j)
    for (std::uint32_t i = 0; i < side_; ++i) {
      const Vec3 p = at(i, j);
      for (int k = 0; k < 3; ++k) {
        append_number(out, p[k]);
        out += k < 2 ? " " : ",\n";
      }
    }
  out += "] }\ncoordIndex [\n";
  const auto face = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t index : {a, b, c}) {
      char text[16];
      out.append(text, static_cast<std::size_t>(std::snprintf(text, sizeof text, "%u, ", index)));
    }
    out += "-1,\n";
  };
  for (std::uint32_t j = 0; j < side_; ++j)
    for (std::uint32_t i = 0; i < side_; ++i) {
      const std::uint32_t a = j * side_ + i, b = j * side_ + (i + 1) % side_;
      face(a, a + side_, b);
      face(b, a + side_, b + side_);
    }
  return out + "] } }\n";
}

std::string Band::glb(bool normals) const {
  std::string data;
  Vec3 low(1), high(-1);
  for (int pass = 0; pass < (normals ? 2 : 1); ++pass)
    for (std::uint32_t j = 0; j <= side_; ++j)
      for (std::uint32_t i = 0; i < side_; ++i) {
        const Vec3 p = pass == 0 ? at(i, j) : glm::normalize(at(i, j));
        for (int k = 0; k < 3; ++k) {
          const auto x = static_cast<float>(p[k]);
          append(data, x);
          if (pass > 0) continue;
          low[k] = std::min(low[k], static_cast<double>(x));
          high[k] = std::max(high[k], static_cast<double>(x));
        }
      }
  const std::size_t vertex_bytes = 12 * vertices();
  const std::size_t index_start = data.size();
  for (std::uint32_t j = 0; j < side_; ++j)
    for (std::uint32_t i = 0; i < side_; ++i) {
      const std::uint32_t a = j * side_ + i, b = j * side_ + (i + 1) % side_;
      for (const std::uint32_t index : {a, a + side_, b, b, a + side_, b + side_})
        append(data, index);
    }
  const auto vector = [](const Vec3& v) {
    char text[96];
    std::snprintf(text, sizeof text, "[%.9g,%.9g,%.9g]", v.x, v.y, v.z);
    return std::string(text);
  };
  const auto number = [](std::uint64_t n) { return std::to_string(n); };
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0)";
  if (normals) json += R"(,"NORMAL":2)";
  json += R"(},"indices":1}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" +
          number(vertices()) + R"(,"type":"VEC3","min":)" + vector(low) + R"(,"max":)" +
          vector(high) + R"(},{"bufferView":1,"componentType":5125,"count":)" +
          number(3 * triangles()) + R"(,"type":"SCALAR"})";
  if (normals)
    json += R"(,{"bufferView":2,"componentType":5126,"count":)" + number(vertices()) +
            R"(,"type":"VEC3"})";
  json += R"(],"bufferViews":[{"buffer":0,"byteLength":)" + number(vertex_bytes) +
          R"(},{"buffer":0,"byteOffset":)" + number(index_start) + R"(,"byteLength":)" +
          number(data.size() - index_start) + "}";
  if (normals)
    json += R"(,{"buffer":0,"byteOffset":)" + number(vertex_bytes) + R"(,"byteLength":)" +
            number(vertex_bytes) + "}";
  json += R"(],"buffers":[{"byteLength":)" + number(data.size()) + "}]}";
  while (json.size() % 4 != 0) json += ' ';
  std::string out = "glTF";
  append(out, std::uint32_t{2});
  append(out, static_cast<std::uint32_t>(28 + json.size() + data.size()));
  append(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  append(out, static_cast<std::uint32_t>(data.size()));
  out += std::string("BIN\0", 4) + data;
  return out;
}

std::string Band::obj() const {
  std::string out = "o band\n";
  for (std::uint32_t j = 0; j <= side_; ++j)
    for (std::uint32_t i = 0; i < side_; ++i) {
      const Vec3 p = at(i, j);
      out += "v";
      for (int k = 0; k < 3; ++k) {
        out += ' ';
        append_number(out, p[k]);
      }
      out += '\n';
    }
  each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    char text[48];
    out.append(text, static_cast<std::size_t>(
                         std::snprintf(text, sizeof text, "f %u %u %u\n", a + 1, b + 1, c + 1)));
  });
  return out;
}

std::string Band::stl() const {
  std::string out(80, ' ');
  append(out, static_cast<std::uint32_t>(triangles()));
  each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    out.append(12, '\0');
    for (const std::uint32_t v : {a, b, c}) {
      const Vec3 p = at(v % side_, v / side_);
      for (int k = 0; k < 3; ++k) append(out, static_cast<float>(p[k]));
    }
    out.append(2, '\0');
  });
  return out;
}

std::string Band::ply() const {
  std::string out =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices()) +
      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
      std::to_string(triangles()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::uint32_t j = 0; j <= side_; ++j)
    for (std::uint32_t i = 0; i < side_; ++i) {
      const Vec3 p = at(i, j);
      for (int k = 0; k < 3; ++k) append(out, p[k]);
    }
  each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    out += '\3';
    for (const std::uint32_t v : {a, b, c}) append(out, v);
  });
  return out;
}

double Band::array_bytes(bool normals) const {
  return static_cast<double>(vertices()) * (normals ? 48.0 : 24.0) +
         static_cast<double>(triangles()) * 12.0;
}

double worst_place(const Band& band, const pan::Model& model) {
  std::uint64_t triangles = 0;
  double worst = 0;
  for (std::size_t m = 0; m < model.meshes().size(); ++m) {
    const pan::MeshView mesh = model.mesh(m);
    triangles += mesh.indices.size() / 3;
    const auto& origin = model.meshes()[m].origin;
    for (const auto& p : mesh.positions)
      worst =
          std::max(worst, band.off(Vec3(p.x, p.y, p.z) + Vec3(origin[0], origin[1], origin[2])));
  }
  return triangles == band.triangles() ? worst : std::numeric_limits<double>::infinity();
}

}  // namespace panwright::bench
