// Draco streams of codes: integers alone, so that every version of the library decodes them to the
// same numbers.
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>

#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "pan/internal/mesh_stream.h"

namespace panwright::pan::internal {
namespace {

constexpr int kAttributes = 2;  // codes of positions, of normals

// A decoder that looks at the attributes before it makes room for them.
template <class Base>
class Guarded : public Base {
 public:
  explicit Guarded(const StreamShape& shape) : shape_(shape) {}

 protected:
  bool DecodeAllAttributes() override {
    const draco::PointCloud& cloud = *this->point_cloud();
    if (cloud.num_attributes() != kAttributes || cloud.num_points() != shape_.vertices ||
        this->mesh()->num_faces() != shape_.triangles)
      return false;
    for (int i = 0; i < kAttributes; ++i) {
      const draco::PointAttribute& attribute = *cloud.attribute(i);
      if (attribute.data_type() != draco::DT_INT32 || attribute.num_components() != 3 - i)
        return false;
    }
    return Base::DecodeAllAttributes();
  }

 private:
  StreamShape shape_;
};

// Head of a stream.
struct Head {
  bool edgebreaker = false;
  std::uint64_t faces = 0;
  std::uint64_t points = 0;
};

// Draco bitstream specification, "Header", "Decode Sequential Indices" and "Decode Edgebreaker
// Connectivity".
std::optional<Head> head_of(std::span<const std::byte> bytes) {
  constexpr std::array<unsigned char, 8> kStart = {'D', 'R', 'A', 'C', 'O', 2, 2, 1};
  std::size_t at = kStart.size();
  if (bytes.size() < 11 || std::memcmp(bytes.data(), kStart.data(), at) != 0) return {};
  const auto byte = [&] { return at < bytes.size() ? static_cast<unsigned>(bytes[at++]) : 256u; };
  const auto varint = [&]() -> std::uint64_t {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const unsigned next = byte();
      if (next > 255) return ~0ull;
      value |= std::uint64_t{next & 127} << shift;
      if (next < 128) return value;
    }
    return ~0ull;
  };
  Head head;
  const unsigned method = byte();
  if (method > 1 || byte() != 0 || byte() != 0) return {};
  head.edgebreaker = method == 1;
  if (!head.edgebreaker) {
    head.faces = varint();
    head.points = varint();
    return head;
  }
  byte();  // the kind of traversal
  head.points = varint();
  head.faces = varint();
  if (byte() > 3) return {};  // attributes with connectivity of their own
  return head;
}

bool read_codes(const draco::Mesh& mesh, int index, std::size_t width,
                std::vector<std::uint32_t>& to) {
  const draco::PointAttribute& from = *mesh.attribute(index);
  to.resize(width * mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const auto value = from.mapped_index(draco::PointIndex(i));
    if (value.value() >= from.size()) return false;
    std::memcpy(&to[width * i], from.GetAddress(value), width * sizeof(std::uint32_t));
  }
  return true;
}

bool decode_guarded(draco::MeshDecoder& decoder, std::span<const std::byte> bytes,
                    const StreamShape& shape, StreamCodes& to,
                    std::vector<std::uint32_t>& indices) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Mesh mesh;
  if (!decoder.Decode(draco::DecoderOptions(), &buffer, &mesh).ok()) return false;
  if (mesh.num_points() != shape.vertices || mesh.num_faces() != shape.triangles ||
      mesh.num_attributes() != kAttributes)
    return false;
  indices.resize(3 * shape.triangles);
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      indices[3 * i + k] = mesh.face(draco::FaceIndex(i))[k].value();
  return read_codes(mesh, 0, 3, to.positions) && read_codes(mesh, 1, 2, to.normals);
}

}  // namespace

bool draco_decoded(std::span<const std::byte> bytes, const StreamShape& shape, StreamCodes& to,
                   std::vector<std::uint32_t>& indices) {
  const auto head = head_of(bytes);
  if (!head || head->faces != shape.triangles || head->points > shape.vertices) return false;
  try {
    if (head->edgebreaker) {
      Guarded<draco::MeshEdgebreakerDecoder> decoder(shape);
      return decode_guarded(decoder, bytes, shape, to, indices);
    }
    Guarded<draco::MeshSequentialDecoder> decoder(shape);
    return decode_guarded(decoder, bytes, shape, to, indices);
  } catch (const std::bad_alloc&) {
    return false;
  } catch (const std::length_error&) {
    return false;
  }
}

}  // namespace panwright::pan::internal
