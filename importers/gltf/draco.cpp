#include "importers/gltf/draco.h"

#include <draco/compression/decode.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/parallel.h"

namespace panwright::importers::gltf {

namespace {

constexpr std::size_t kBlock = 1 << 15;  // points of one piece of parallel work

// Reads the parts of a head one by one; fails for good at the end of the bytes.
class HeadReader {
 public:
  explicit HeadReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    if (!good_ || bytes_.size() - at_ < size) return fail();
    for (std::size_t i = 0; i < size; ++i)
      value |= std::uint64_t{static_cast<std::uint8_t>(bytes_[at_ + i])} << (8 * i);
    at_ += size;
    return value;
  }

  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const std::uint64_t byte = number(1);
      value |= (byte & 127) << shift;
      if (byte < 128) return good_ ? value : 0;
    }
    return fail();
  }

  void skip(std::uint64_t size) {
    if (!good_ || bytes_.size() - at_ < size)
      fail();
    else
      at_ += size;
  }

  void skip_metadata(int depth) {
    if (depth > 64) {
      fail();
      return;
    }
    for (std::uint64_t entries = varint(); good_ && entries > 0; --entries) {
      skip(number(1));
      skip(varint());
    }
    for (std::uint64_t below = varint(); good_ && below > 0; --below) {
      skip(number(1));
      skip_metadata(depth + 1);
    }
  }

  bool good() const { return good_; }

 private:
  std::uint64_t fail() {
    good_ = false;
    return 0;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace

// Draco bitstream specification, "Header", "Metadata", "Decode Sequential Indices" and "Decode
// Edgebreaker Connectivity".
std::optional<DracoHead> draco_head(std::span<const std::byte> bytes) {
  if (bytes.size() < 11 || std::memcmp(bytes.data(), "DRACO", 5) != 0) return std::nullopt;
  HeadReader reader(bytes);
  reader.skip(5);
  const std::uint64_t major = reader.number(1), minor = reader.number(1);
  const std::uint64_t version = major << 8 | minor;
  DracoHead head;
  head.mesh = reader.number(1) == 1;
  const std::uint64_t method = reader.number(1), flags = reader.number(2);
  if (version >= 0x0103 && (flags & 0x8000) != 0) {
    for (std::uint64_t count = reader.varint(); reader.good() && count > 0; --count) {
      reader.varint();
      reader.skip_metadata(0);
    }
    reader.skip_metadata(0);
  }
  const auto count = [&](std::uint64_t since) {
    return version >= since ? reader.varint() : reader.number(4);
  };
  if (!head.mesh) {
    head.points = reader.number(4);
  } else if (method == 0) {
    head.faces = count(0x0202);
    head.points = count(0x0202);
  } else {
    reader.skip(1);
    if (version < 0x0202) count(0x0200);
    head.points = count(0x0200);
    head.faces = count(0x0200);
  }
  if (!reader.good()) return std::nullopt;
  return head;
}

struct DracoMesh::State {
  std::unique_ptr<draco::Mesh> mesh;
};

std::optional<DracoMesh> DracoMesh::decoded(std::span<const std::byte> bytes,
                                            std::string& problem) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto result = decoder.DecodeMeshFromBuffer(&buffer);
  if (!result.ok()) {
    problem = result.status().error_msg_string();
    return std::nullopt;
  }
  auto state = std::make_shared<State>();
  state->mesh = std::move(result).value();
  return DracoMesh(std::move(state));
}

std::uint64_t DracoMesh::points() const { return state_->mesh->num_points(); }
std::uint64_t DracoMesh::faces() const { return state_->mesh->num_faces(); }

std::vector<geometry::Triangle> DracoMesh::triangles() const {
  const draco::Mesh& mesh = *state_->mesh;
  std::vector<geometry::Triangle> triangles(mesh.num_faces());
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(i));
    for (std::size_t k = 0; k < 3; ++k) triangles[i][k] = face[k].value();
  }
  return triangles;
}

namespace {

template <class T>
void read_as(const draco::PointAttribute& from, std::size_t points, const DracoAttribute& to) {
  const std::size_t width =
      std::min<std::size_t>(to.width, static_cast<std::size_t>(from.num_components()));
  const std::size_t blocks = (points + kBlock - 1) / kBlock;
  parallel_for(blocks, [&](std::size_t block) {
    const std::size_t end = std::min(points, (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i) {
      const auto value = from.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
      T numbers[4];
      std::memcpy(numbers, from.GetAddress(value), width * sizeof(T));
      for (std::size_t k = 0; k < width; ++k) {
        const double x = static_cast<double>(numbers[k]) * to.scale;
        to.numbers[i * to.width + k] = to.clamped ? std::max(x, -1.0) : x;
      }
    }
  });
}

}  // namespace

bool DracoMesh::read(const DracoAttribute& attribute) const {
  const draco::PointAttribute* from = state_->mesh->GetAttributeByUniqueId(attribute.id);
  if (!from) return false;
  const std::size_t points = state_->mesh->num_points();
  // a value index beyond the attribute would be read out of bounds
  for (std::uint32_t i = 0; i < points; ++i)
    if (from->mapped_index(draco::PointIndex(i)).value() >= from->size()) return false;
  switch (from->data_type()) {
    case draco::DT_INT8:
      read_as<std::int8_t>(*from, points, attribute);
      return true;
    case draco::DT_UINT8:
      read_as<std::uint8_t>(*from, points, attribute);
      return true;
    case draco::DT_INT16:
      read_as<std::int16_t>(*from, points, attribute);
      return true;
    case draco::DT_UINT16:
      read_as<std::uint16_t>(*from, points, attribute);
      return true;
    case draco::DT_INT32:
      read_as<std::int32_t>(*from, points, attribute);
      return true;
    case draco::DT_UINT32:
      read_as<std::uint32_t>(*from, points, attribute);
      return true;
    case draco::DT_FLOAT32:
      read_as<float>(*from, points, attribute);
      return true;
    default:
      return false;
  }
}

}  // namespace panwright::importers::gltf
