#include "pan/storage.h"

#include <fmt/core.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstring>

#include "pan/internal/mesh_stream.h"

namespace panwright::pan {

namespace {

using Kind = StorageForm::Kind;
constexpr std::array<std::string_view, 3> kNames = {"none", "lossless", "lossy"};

template <class T>
void append(std::vector<std::byte>& to, const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  to.insert(to.end(), bytes.begin(), bytes.end());
  to.resize((to.size() + 3) / 4 * 4);
}

std::uint32_t code_of(double low, double step, std::uint32_t bits, float value) {
  if (!(step > 0)) return 0;
  const auto most = static_cast<double>((1u << bits) - 1);
  return static_cast<std::uint32_t>(std::clamp(std::floor((value - low) / step + 0.5), 0.0, most));
}

double longest_side(const PackedMesh& mesh, double low[3]) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    double least = mesh.positions[k], most = least;
    for (std::size_t i = k; i < mesh.positions.size(); i += 3) {
      least = std::min<double>(least, mesh.positions[i]);
      most = std::max<double>(most, mesh.positions[i]);
    }
    low[k] = least;
    longest = std::max(longest, most - least);
  }
  return longest;
}

double angle_of_directions(const float* a, const float* b) {
  const Vec3 p(a[0], a[1], a[2]), q(b[0], b[1], b[2]);
  return det::atan2(glm::length(glm::cross(p, q)), glm::dot(p, q));
}

// The codes of a mesh, as its stream's record says.
internal::StreamCodes codes_of(const PackedMesh& mesh) {
  internal::StreamCodes out;
  const layout::MeshStream& record = mesh.stream;
  if (record.position_bits > 0)
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      out.positions.push_back(
          code_of(record.low[i % 3], record.step, record.position_bits, mesh.positions[i]));
  if (record.normal_bits > 0) {
    out.normals.resize(2 * mesh.vertex_count());
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
      internal::codes_of(&mesh.normals[3 * v], record.normal_bits, &out.normals[2 * v]);
  }
  return out;
}

template <class To>
std::vector<To> as(const std::vector<std::uint32_t>& codes) {
  return std::vector<To>(codes.begin(), codes.end());
}

std::vector<std::byte> packed_vertices(const void* from, std::size_t count, std::size_t stride) {
  std::vector<std::byte> out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                        from, count, stride));
  return out;
}

// Turns triangles so that they begin where the codec has them begin.
std::vector<std::byte> meshopt_body(PackedMesh& mesh, const internal::StreamCodes& codes) {
  const std::size_t n = mesh.vertex_count();
  std::vector<std::byte> parts[3];
  if (codes.positions.empty()) {
    parts[0] = packed_vertices(mesh.positions.data(), n, 12);
  } else if (mesh.stream.position_bits <= 16) {
    std::vector<std::uint16_t> four(4 * n);
    for (std::size_t i = 0; i < 3 * n; ++i)
      four[i / 3 * 4 + i % 3] = static_cast<std::uint16_t>(codes.positions[i]);
    parts[0] = packed_vertices(four.data(), n, 8);
  } else {
    parts[0] = packed_vertices(codes.positions.data(), n, 12);
  }
  parts[1] = codes.normals.empty() ? packed_vertices(mesh.normals.data(), n, 12)
                                   : packed_vertices(as<std::uint16_t>(codes.normals).data(), n, 4);
  const std::size_t count = mesh.indices.size();
  parts[2].resize(meshopt_encodeIndexBufferBound(count, n));
  auto* data = reinterpret_cast<unsigned char*>(parts[2].data());
  parts[2].resize(meshopt_encodeIndexBuffer(data, parts[2].size(), mesh.indices.data(), count));
  [[maybe_unused]] const int failed =
      meshopt_decodeIndexBuffer(mesh.indices.data(), count, 4, data, parts[2].size());
  assert(failed == 0);
  std::vector<std::uint32_t> lengths;
  for (const auto& part : parts) lengths.push_back(static_cast<std::uint32_t>(part.size()));
  std::vector<std::byte> out;
  append(out, lengths);
  for (const auto& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

// Vertices that their codes do not give to the bit, with their numbers.
std::uint32_t put_exact(const std::vector<float>& values, const std::vector<float>& decoded,
                        std::vector<std::byte>& to) {
  std::vector<std::uint32_t> vertices;
  std::vector<float> numbers;
  for (std::size_t i = 0; i < values.size(); i += 3) {
    if (std::memcmp(&values[i], &decoded[i], 12) == 0) continue;
    vertices.push_back(static_cast<std::uint32_t>(i / 3));
    numbers.insert(numbers.end(), &values[i], &values[i] + 3);
  }
  append(to, vertices);
  append(to, numbers);
  return static_cast<std::uint32_t>(vertices.size());
}

}  // namespace

std::optional<StorageForm> storage_form(std::string_view text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const auto name = std::find(kNames.begin(), kNames.end(), text.substr(0, colon));
  if (name == kNames.end()) return {};
  StorageForm form{static_cast<Kind>(name - kNames.begin()), 0};
  if (form.streams()) form.bits = 16;
  if (colon == text.size()) return form;
  const std::string_view digits = text.substr(colon + 1);
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), form.bits);
  if (error != std::errc() || end != digits.data() + digits.size() || !form.streams() ||
      form.bits < kLeastStorageBits || form.bits > kMostStorageBits)
    return {};
  return form;
}

std::string storage_name(const StorageForm& form) {
  std::string name(kNames[static_cast<std::size_t>(form.kind)]);
  return form.bits > 0 ? fmt::format("{}:{}", name, form.bits) : name;
}

std::uint32_t normal_bits(std::uint32_t bits) {
  return bits == 0 ? 0 : bits <= 11 ? 10 : bits <= 14 ? 12 : 14;
}

std::uint32_t bits_within(const PackedMesh& mesh, std::uint32_t bits, double most) {
  double low[3];
  const double side = longest_side(mesh, low);
  for (; bits <= kMostStorageBits; ++bits)
    if (side / ((1u << bits) - 1) * std::sqrt(0.75) + side * 6e-8 <= most) return bits;
  return 0;
}

void snap_normals(PackedMesh& mesh, std::uint32_t bits) {
  mesh.stream.normal_bits = bits;
  double worst = mesh.stream.normal_error;
  for (std::size_t i = 0; i < mesh.normals.size(); i += 3) {
    std::uint32_t codes[2];
    float to[3];
    internal::codes_of(&mesh.normals[i], bits, codes);
    internal::normal_of(codes[0], codes[1], bits, to);
    worst = std::max(worst, angle_of_directions(to, &mesh.normals[i]));
    std::copy_n(to, 3, &mesh.normals[i]);
  }
  mesh.stream.normal_error = worst;
}

void snap(PackedMesh& mesh, std::uint32_t bits, std::uint32_t normals,
          std::span<const char> exact) {
  assert(exact.empty() || exact.size() == mesh.vertex_count());
  if (normals > 0) snap_normals(mesh, normals);
  if (bits == 0) return;
  layout::MeshStream& record = mesh.stream;
  record.position_bits = bits;
  record.step = longest_side(mesh, record.low) / ((1u << bits) - 1);
  double worst = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!exact.empty() && exact[v]) continue;
    float* p = &mesh.positions[3 * v];
    Vec3 moved(0);
    for (int k = 0; k < 3; ++k) {
      const float to = internal::position_of(record.low[k], record.step,
                                             code_of(record.low[k], record.step, bits, p[k]));
      moved[k] = double{to} - p[k];
      p[k] = to;
    }
    worst = std::max(worst, glm::length(moved));
  }
  record.position_error = worst;
  mesh.error += worst;
}

void encode(PackedMesh& mesh) {
  const internal::StreamShape shape{mesh.vertex_count(), mesh.triangle_count(),
                                    mesh.vertex_count() <= layout::kMaxShortVertices ? 2u : 4u};
  const internal::StreamCodes codes = codes_of(mesh);
  layout::MeshStream& record = mesh.stream;
  record.form = static_cast<std::uint32_t>(layout::StreamForm::meshopt);
  const std::vector<std::byte> body = meshopt_body(mesh, codes);
  std::vector<float> positions = mesh.positions, normals = mesh.normals;
  for (std::size_t i = 0; i < codes.positions.size(); ++i)
    positions[i] = internal::position_of(record.low[i % 3], record.step, codes.positions[i]);
  for (std::size_t v = 0; 2 * v < codes.normals.size(); ++v)
    internal::normal_of(codes.normals[2 * v], codes.normals[2 * v + 1], record.normal_bits,
                        &normals[3 * v]);
  std::vector<std::byte>& out = mesh.stream_bytes;
  out.clear();
  record.exact_positions = put_exact(mesh.positions, positions, out);
  record.exact_normals = put_exact(mesh.normals, normals, out);
  out.insert(out.end(), body.begin(), body.end());
  const std::uint64_t least = internal::streamed_bytes(shape) / layout::kMaxStreamed + 1;
  out.resize((std::max<std::uint64_t>(out.size(), least) + 3) / 4 * 4);
  record.length = out.size();
}

}  // namespace panwright::pan
