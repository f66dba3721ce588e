#include "pan/internal/mesh_stream.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <utility>

namespace panwright::pan::internal {
namespace {

using layout::StreamForm;

// Takes the parts of a stream one by one; fails for good at its end.
class Parts {
 public:
  explicit Parts(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::span<const std::byte> take(std::uint64_t size) {
    if (!good_ || size > bytes_.size()) {
      good_ = false;
      return {};
    }
    const auto part = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return part;
  }
  std::uint32_t number() {
    const auto part = take(sizeof(std::uint32_t));
    std::uint32_t value = 0;
    if (good_) std::memcpy(&value, part.data(), sizeof value);
    return value;
  }
  std::span<const std::byte> rest() const { return bytes_; }
  bool good() const { return good_; }

 private:
  std::span<const std::byte> bytes_;
  bool good_ = true;
};

// Codes of `width` numbers each, `stride` apart, as floats.
template <class T>
bool positions_from(const layout::MeshStream& record, const T* codes, std::size_t stride,
                    std::size_t count, float* to) {
  std::uint32_t all = 0;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t code = codes[stride * i + k];
      all |= code;
      to[3 * i + k] = position_of(record.low[k], record.step, code);
    }
  return all >> record.position_bits == 0;
}

template <class T>
bool normals_from(std::uint32_t bits, const T* codes, std::size_t count, float* to) {
  std::uint32_t all = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t u = codes[2 * i], v = codes[2 * i + 1];
    all |= u | v;
    normal_of(u, v, bits, to + 3 * i);
  }
  return all >> bits == 0;
}

// Elements of a plain part, at an address of their alignment.
template <class T>
std::vector<T> elements(std::span<const std::byte> part) {
  std::vector<T> out(part.size() / sizeof(T));
  if (!part.empty()) std::memcpy(out.data(), part.data(), out.size() * sizeof(T));
  return out;
}

std::uint64_t padded(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }

bool decode_plain(const layout::MeshStream& record, const StreamShape& shape, Parts& parts,
                  const StreamTarget& to) {
  const std::uint64_t n = shape.vertices;
  bool good = true;
  if (record.position_bits == 0) {
    const auto part = parts.take(12 * n);
    if (parts.good()) std::memcpy(to.positions, part.data(), part.size());
  } else if (record.position_bits <= 16) {
    const auto codes = elements<std::uint16_t>(parts.take(padded(6 * n)));
    good = parts.good() && positions_from(record, codes.data(), 3, n, to.positions);
  } else {
    const auto codes = elements<std::uint32_t>(parts.take(12 * n));
    good = parts.good() && positions_from(record, codes.data(), 3, n, to.positions);
  }
  if (!good || !parts.good()) return false;
  if (record.normal_bits == 0) {
    const auto part = parts.take(12 * n);
    if (parts.good()) std::memcpy(to.normals, part.data(), part.size());
  } else {
    const auto codes = elements<std::uint16_t>(parts.take(4 * n));
    good = parts.good() && normals_from(record.normal_bits, codes.data(), n, to.normals);
  }
  const auto indices = parts.take(index_run(shape));
  if (!good || !parts.good()) return false;
  std::memcpy(to.indices, indices.data(), indices.size());
  return true;
}

bool decode_vertices(std::span<const std::byte> part, std::size_t count, std::size_t stride,
                     void* to) {
  return meshopt_decodeVertexBuffer(to, count, stride,
                                    reinterpret_cast<const unsigned char*>(part.data()),
                                    part.size()) == 0;
}

bool decode_meshopt(const layout::MeshStream& record, const StreamShape& shape, Parts& parts,
                    const StreamTarget& to) {
  const std::uint32_t lengths[] = {parts.number(), parts.number(), parts.number()};
  const auto positions = parts.take(lengths[0]), normals = parts.take(lengths[1]),
             indices = parts.take(lengths[2]);
  if (!parts.good()) return false;
  const std::size_t n = shape.vertices;
  if (record.position_bits == 0) {
    if (!decode_vertices(positions, n, 12, to.positions)) return false;
  } else if (record.position_bits <= 16) {
    std::vector<std::uint16_t> codes(4 * n);
    if (!decode_vertices(positions, n, 8, codes.data()) ||
        !positions_from(record, codes.data(), 4, n, to.positions))
      return false;
  } else {
    std::vector<std::uint32_t> codes(3 * n);
    if (!decode_vertices(positions, n, 12, codes.data()) ||
        !positions_from(record, codes.data(), 3, n, to.positions))
      return false;
  }
  if (record.normal_bits == 0) {
    if (!decode_vertices(normals, n, 12, to.normals)) return false;
  } else {
    std::vector<std::uint16_t> codes(2 * n);
    if (!decode_vertices(normals, n, 4, codes.data()) ||
        !normals_from(record.normal_bits, codes.data(), n, to.normals))
      return false;
  }
  return meshopt_decodeIndexBuffer(to.indices, 3 * shape.triangles, shape.index_size,
                                   reinterpret_cast<const unsigned char*>(indices.data()),
                                   indices.size()) == 0;
}

bool decode_draco(const layout::MeshStream& record, const StreamShape& shape, Parts& parts,
                  const StreamTarget& to) {
  StreamCodes codes;
  std::vector<std::uint32_t> indices;
  if (record.position_bits == 0 || record.normal_bits == 0 ||
      !draco_decoded(parts.rest(), shape, codes, indices) ||
      !positions_from(record, codes.positions.data(), 3, shape.vertices, to.positions) ||
      !normals_from(record.normal_bits, codes.normals.data(), shape.vertices, to.normals))
    return false;
  if (shape.index_size == 4) {
    std::memcpy(to.indices, indices.data(), indices.size() * 4);
    return true;
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const auto index = static_cast<std::uint16_t>(indices[i]);
    if (index != indices[i]) return false;
    std::memcpy(to.indices + 2 * i, &index, 2);
  }
  return true;
}

// Vertices in ascending order, then three floats for each.
struct Exact {
  std::vector<std::uint32_t> vertices;
  std::vector<float> values;

  bool take(Parts& parts, std::uint64_t count, std::size_t most) {
    if (count > most) return false;
    vertices = elements<std::uint32_t>(parts.take(4 * count));
    values = elements<float>(parts.take(12 * count));
    return parts.good() && (vertices.empty() || vertices.back() < most) &&
           std::adjacent_find(vertices.begin(), vertices.end(), std::greater_equal<>()) ==
               vertices.end();
  }
  void put(float* to) const {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      std::memcpy(to + 3 * std::size_t{vertices[i]}, &values[3 * i], 12);
  }
};

}  // namespace

std::uint64_t index_run(const StreamShape& shape) {
  return padded(std::uint64_t{3} * shape.triangles * shape.index_size);
}

std::uint64_t streamed_bytes(const StreamShape& shape) {
  return std::uint64_t{24} * shape.vertices + index_run(shape);
}

// note: of at least 2 bits, so that the middle is a code and the axes are exact
void normal_of(std::uint32_t u, std::uint32_t v, std::uint32_t bits, float* to) {
  const double most = static_cast<double>((1u << bits) - 2);
  double x = 2.0 * u / most - 1, y = 2.0 * v / most - 1;
  const double z = 1 - std::fabs(x) - std::fabs(y);
  if (z < 0) {
    const double folded = (1 - std::fabs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::fabs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  const double scale = 1 / std::sqrt(x * x + y * y + z * z);
  to[0] = static_cast<float>(x * scale);
  to[1] = static_cast<float>(y * scale);
  to[2] = static_cast<float>(z * scale);
}

void codes_of(const float* normal, std::uint32_t bits, std::uint32_t* to) {
  const double sum =
      std::fabs(double{normal[0]}) + std::fabs(double{normal[1]}) + std::fabs(double{normal[2]});
  const double most = static_cast<double>((1u << bits) - 2);
  double x = sum > 0 ? normal[0] / sum : 0, y = sum > 0 ? normal[1] / sum : 0;
  if (normal[2] < 0) {
    const double folded = (1 - std::fabs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::fabs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  const auto code = [&](double t) {
    return static_cast<std::uint32_t>(std::clamp(std::floor((t + 1) / 2 * most + 0.5), 0.0, most));
  };
  to[0] = code(x);
  to[1] = code(y);
}

bool decode(const layout::MeshStream& record, const StreamShape& shape,
            std::span<const std::byte> stream, const StreamTarget& to) {
  if (record.normal_bits == 1) return false;
  Parts parts(stream);
  Exact positions, normals;
  if (!positions.take(parts, record.exact_positions, shape.vertices) ||
      !normals.take(parts, record.exact_normals, shape.vertices))
    return false;
  const std::uint64_t used = std::uint64_t{3} * shape.triangles * shape.index_size;
  std::memset(to.indices + used, 0, index_run(shape) - used);
  bool good = false;
  switch (static_cast<StreamForm>(record.form)) {
    case StreamForm::plain:
      good = decode_plain(record, shape, parts, to);
      break;
    case StreamForm::meshopt:
      good = decode_meshopt(record, shape, parts, to);
      break;
    case StreamForm::draco:
      good = decode_draco(record, shape, parts, to);
      break;
  }
  if (!good) return false;
  positions.put(to.positions);
  normals.put(to.normals);
  return true;
}

}  // namespace panwright::pan::internal
