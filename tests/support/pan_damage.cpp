#include "tests/support/pan_damage.h"

#include <cstring>
#include <functional>
#include <limits>

#include "pan/writer.h"
#include "tests/support/pan_damage_collection.h"

namespace panwright::support {

namespace {

using namespace pan::layout;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kHuge = ~0ull;

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = as_bytes(text);
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> replaced(std::string_view from, std::string_view to) {
  const std::vector<std::byte> file = small_pan();
  std::string text(reinterpret_cast<const char*>(file.data()), file.size());
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return bytes_of(text);
}

void frame_of_file(Collection& add) {
  using Seal = Collection::Seal;
  add.raw(Code("E4001"), "an empty file", {});
  add.raw(Code("E4001"), "a text file", bytes_of("<pangu_model ver=\"0\"/>\n"));
  add.raw(Code("E4002"), "line feeds became CR LF", replaced("\n", "\r\n"));
  add.raw(Code("E4002"), "CR LF became line feeds", replaced("\r\n", "\n"));
  add.raw(Code("E4002"), "carriage returns became line feeds", replaced("\r", "\n"));
  add.raw(Code("E4002"), "line feeds became carriage returns", replaced("\n", "\r"));
  add.raw(Code("E4002"), "the eighth bit was lost", replaced("\x89PAN", "\tPAN"));
  add.raw(Code("E4002"), "ISO-8859-1 became UTF-8", replaced("\x89PAN", "\xc2\x89PAN"));
  add.changed(
      Code("E4003"), "a big-endian file", [](OpenPan& f) { f.header().endian = 0x01020304; },
      Seal::header);
  add.changed(
      Code("E4003"), "format 2.0", [](OpenPan& f) { f.header().major = 2; }, Seal::header);
  add.changed(
      Code("E4004"), "an unknown required feature",
      [](OpenPan& f) { f.header().required_features = 1ull << 63; }, Seal::header);
  add.changed(Code("E4004"), "an unknown section that is not optional",
              [](OpenPan& f) { f.add_section(77, false, 64, std::vector<std::byte>(64)); });
  add.changed(Code("E4004"), "a known section of version 2",
              [](OpenPan& f) { f.entry(SectionKind::nodes).version = 2; });
  add.raw(Code("E4005"), "the magic alone", bytes_of(std::string_view("\x89PAN\r\n\x1a\n", 8)));
  add.raw(Code("E4005"), "half a file", [] {
    auto bytes = small_pan();
    bytes.resize(bytes.size() / 2);
    return bytes;
  }());
  add.raw(Code("E4005"), "a file with a byte behind it", [] {
    auto bytes = small_pan();
    bytes.push_back(std::byte{0});
    return bytes;
  }());
  add.changed(
      Code("E4006"), "no complete mark", [](OpenPan& f) { f.header().complete = 0; }, Seal::header);
  add.changed(
      Code("E4007"), "a changed header", [](OpenPan& f) { f.header().minor = 9; }, Seal::none);
  add.changed(
      Code("E4007"), "a changed directory", [](OpenPan& f) { f.entry(std::size_t{3}).count += 1; },
      Seal::none);
  add.changed(
      Code("E4009"), "a changed section",
      [](OpenPan& f) { f.at<Float3>(SectionKind::positions, 0).x += 1; }, Seal::none);
  add.changed(
      Code("E4009"), "changed padding",
      [](OpenPan& f) {
        f.at<std::uint8_t>(SectionKind::build, f.entry(SectionKind::build).raw_length) = 1;
      },
      Seal::none);
  add.changed(
      Code("E4012"), "a reserved word of the header",
      [](OpenPan& f) { f.header().reserved[4] = 1; }, Seal::header);
}

void directory(Collection& add) {
  using Seal = Collection::Seal;
  const auto header = [&](const char* what, const std::function<void(Header&)>& change) {
    add.changed(
        Code("E4008"), what, [&](OpenPan& f) { change(f.header()); }, Seal::header);
  };
  header("a directory past the end", [](Header& h) { h.directory_offset = h.total_length + 64; });
  header("a directory near 2^64", [](Header& h) { h.directory_offset = kHuge - 63; });
  header("a directory inside the header", [](Header& h) { h.directory_offset = 64; });
  header("a directory off its alignment", [](Header& h) { h.directory_offset += 1; });
  header("2^32 - 1 sections", [](Header& h) { h.section_count = 0xffffffffu; });
  header("one section too few", [](Header& h) { h.section_count -= 1; });
  const auto entry = [&](const char* what, const std::function<void(DirectoryEntry&)>& change) {
    add.changed(
        Code("E4008"), what, [&](OpenPan& f) { change(f.entry(SectionKind::meshes)); },
        Seal::directory);
  };
  entry("an offset near 2^64", [](DirectoryEntry& e) { e.offset = kHuge - 63; });
  entry("overlapping sections", [](DirectoryEntry& e) { e.offset -= 64; });
  entry("a gap between sections", [](DirectoryEntry& e) { e.offset += 64; });
  entry("a length near 2^64", [](DirectoryEntry& e) { e.stored_length = kHuge - 63; });
  entry("a length past the directory", [](DirectoryEntry& e) { e.stored_length = 1 << 20; });
  entry("count times size over 2^64", [](DirectoryEntry& e) {
    // 2^61 * 96 = 2^66 + 2^65, which is 0 in 64 bits
    e.count = 1ull << 61;
    e.raw_length = 0;
  });
  entry("count times size that wraps round to the right size", [](DirectoryEntry& e) {
    // 2^59 * 96 = 3 * 2^64
    e.count += 1ull << 59;
  });
  entry("a count near 2^64", [](DirectoryEntry& e) { e.count = kHuge; });
  entry("elements of no size", [](DirectoryEntry& e) { e.stride = 0; });
  entry("elements of another size", [](DirectoryEntry& e) {
    e.stride /= 2;
    e.count *= 2;
  });
  entry("more padding than needed", [](DirectoryEntry& e) {
    e.count = 0;
    e.raw_length = 0;
  });
  entry("an unknown flag", [](DirectoryEntry& e) { e.flags = 2; });
  entry("a packed length without a codec", [](DirectoryEntry& e) { e.packed_length = 1; });
  entry("a codec that the header does not speak of", [](DirectoryEntry& e) { e.codec = 1; });
  entry("a missing section", [](DirectoryEntry& e) {
    e.kind = 99;
    e.flags = 1;
  });
  entry("a section twice", [](DirectoryEntry& e) {
    e.kind = static_cast<std::uint32_t>(SectionKind::nodes);
    e.stride = sizeof(Node);
    e.raw_length = e.count * e.stride;
  });
}

void sections(Collection& add) {
  add.changed(Code("E4008"), "a section that stands twice besides the others", [](OpenPan& f) {
    f.add_section(static_cast<std::uint32_t>(SectionKind::build), false, 16,
                  std::vector<std::byte>(64));
  });
  add.changed(Code("E4008"), "a block of padding", [](OpenPan& f) {
    f.add_section(1000, true, 1, std::vector<std::byte>(128));
    f.entry(kSampleSections).count = f.entry(kSampleSections).raw_length = 64;
  });
  add.changed(Code("E4008"), "more sections than the limit", [](OpenPan& f) {
    for (std::size_t i = kSampleSections; i <= kMaxSections; ++i) f.add_section(1000, true, 1, {});
  });
  add.raw(Code("E4008"), "a directory off its alignment, its length right", [] {
    std::vector<std::byte> bytes = small_pan();
    std::uint64_t offset = 0;
    std::memcpy(&offset, &bytes[offsetof(Header, directory_offset)], sizeof offset);
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(offset), std::byte{0});
    OpenPan file(std::move(bytes));
    file.header().directory_offset += 1;
    file.header().total_length += 1;
    return file.seal_header().bytes();
  }());
  add.changed(Code("E4008"), "padding that is not zero", [](OpenPan& f) {
    f.at<std::uint8_t>(SectionKind::build, f.entry(SectionKind::build).raw_length) = 1;
  });
  add.changed(Code("E4008"), "no sections", [](OpenPan& f) {
    f = OpenPan([] {
      DiagnosticLog log;
      auto writer = pan::Writer::in_memory();
      writer.finish({}, log);
      return std::move(writer).take();
    }());
  });
}

void nodes(Collection& add) {
  const auto node = [&](Code code, const char* what, const std::function<void(Node*)>& change) {
    add.changed(code, what, [&](OpenPan& f) { change(&f.at<Node>(SectionKind::nodes, 0)); });
  };
  node(Code("E4011"), "a node below itself", [](Node* n) { n[1].parent = 1; });
  node(Code("E4011"), "two nodes below each other", [](Node* n) {
    n[1].parent = 2;
    n[2].parent = 1;
  });
  node(Code("E4011"), "a root with a parent", [](Node* n) { n[0].parent = 0; });
  node(Code("E4011"), "a parent past the end", [](Node* n) { n[1].parent = 0x7fffffff; });
  node(Code("E4010"), "two roots", [](Node* n) { n[1].parent = -1; });
  node(Code("E4010"), "a parent of -2", [](Node* n) { n[1].parent = -2; });
  add.changed(Code("E4010"), "a name one past the strings", [](OpenPan& f) {
    f.at<Node>(SectionKind::nodes, 0).name =
        static_cast<std::uint32_t>(f.entry(SectionKind::string_offsets).count - 1);
  });
  node(Code("E4012"), "a NaN translation", [](Node* n) { n[1].translation[1] = kNan; });
  node(Code("E4012"), "an infinite translation", [](Node* n) { n[1].translation[2] = -kInfinity; });
  node(Code("E4012"), "a quaternion of length 2", [](Node* n) { n[1].rotation[0] = 2; });
  node(Code("E4012"), "a quaternion of zero", [](Node* n) { n[0].rotation[0] = 0; });
  node(Code("E4012"), "a quaternion 1e-11 off", [](Node* n) { n[0].rotation[0] = 1 + 1e-11; });
  node(Code("E4012"), "a NaN quaternion", [](Node* n) { n[1].rotation[3] = kNan; });
  node(Code("E4012"), "a scale of zero", [](Node* n) { n[1].scale[0] = 0; });
  node(Code("E4012"), "a scale of minus zero", [](Node* n) { n[1].scale[0] = -0.0; });
  node(Code("E4012"), "a NaN scale", [](Node* n) { n[1].scale[0] = kNan; });
  node(Code("E4012"), "scales whose product overflows", [](Node* n) {
    n[0].scale[1] = 1e200;
    n[1].scale[1] = 1e200;
  });
  node(Code("E4012"), "an instance whose vertices overflow",
       [](Node* n) { n[1].scale[0] = 1.7e308; });
  add.changed(Code("E4012"), "an overflow at a node that carries nothing", [](OpenPan& f) {
    f.at<Node>(SectionKind::nodes, 1).scale[1] = 1e200;
    f.at<Node>(SectionKind::nodes, 2).scale[1] = 1e200;
    f.at<Instance>(SectionKind::instances, 1).node = 0;
  });
  add.changed(Code("E4012"), "no nodes", [](OpenPan& f) {
    f.resize_section(SectionKind::nodes, 0);
    f.resize_section(SectionKind::frames, 0);
    f.resize_section(SectionKind::instances, 0);
    f.resize_section(SectionKind::sources, 0);
    f.resize_section(SectionKind::keypoints, 0);
    f.resize_section(SectionKind::decals, 0);
  });
  add.changed(Code("E4012"), "a chain of nodes deeper than the limit", [](OpenPan& f) {
    const Node root = f.at<Node>(SectionKind::nodes, 0);
    f.resize_section(SectionKind::nodes, kMaxDepth + 1);
    for (std::size_t i = 1; i <= kMaxDepth; ++i) {
      f.at<Node>(SectionKind::nodes, i) = root;
      f.at<Node>(SectionKind::nodes, i).parent = static_cast<std::int32_t>(i) - 1;
    }
  });
}

void meshes(Collection& add) {
  const auto mesh = [&](Code code, const char* what, const std::function<void(Mesh*)>& change) {
    add.changed(code, what, [&](OpenPan& f) { change(&f.at<Mesh>(SectionKind::meshes, 0)); });
  };
  mesh(Code("E4010"), "a first vertex near 2^32", [](Mesh* m) { m[1].first_vertex = 0xffffffffu; });
  mesh(Code("E4010"), "runs of vertices that overlap", [](Mesh* m) { m[1].first_vertex = 3; });
  mesh(Code("E4010"), "a vertex more than there are", [](Mesh* m) { m[1].vertex_count += 1; });
  mesh(Code("E4010"), "2^32 - 1 vertices", [](Mesh* m) {
    m[1].vertex_count = 0xffffffffu;
    m[1].index_size = 4;
  });
  mesh(Code("E4010"), "2^32 - 1 triangles", [](Mesh* m) { m[1].triangle_count = 0xffffffffu; });
  mesh(Code("E4010"), "an index offset near 2^64", [](Mesh* m) { m[1].index_offset = kHuge - 3; });
  mesh(Code("E4010"), "texcoords before the first",
       [](Mesh* m) { m[1].first_texcoord = 0xffffffffu; });
  mesh(Code("E4010"), "colours past the end", [](Mesh* m) { m[1].first_color = 1; });
  mesh(Code("E4010"), "texcoords that are not there",
       [](Mesh* m) { m[0].flags |= kMeshTexcoords; });
  mesh(Code("E4010"), "texcoords that no mesh has", [](Mesh* m) { m[1].flags &= ~kMeshTexcoords; });
  mesh(Code("E4010"), "a mesh's name", [](Mesh* m) { m[0].name = 0xffffffffu; });
  mesh(Code("E4012"), "two vertices", [](Mesh* m) { m[0].vertex_count = 2; });
  mesh(Code("E4012"), "no triangles", [](Mesh* m) { m[0].triangle_count = 0; });
  mesh(Code("E4012"), "indices of 3 bytes", [](Mesh* m) { m[0].index_size = 3; });
  mesh(Code("E4012"), "short indices of a large mesh", [](Mesh* m) { m[0].vertex_count = 65536; });
  mesh(Code("E4012"), "an unknown flag of a mesh", [](Mesh* m) { m[0].flags |= 0x80000000u; });
  mesh(Code("E4012"), "a NaN origin", [](Mesh* m) { m[0].origin[0] = kNan; });
  mesh(Code("E4012"), "a negative error", [](Mesh* m) { m[0].error = -1e-9; });
  mesh(Code("E4012"), "a NaN error", [](Mesh* m) { m[0].error = kNan; });
  mesh(Code("E4012"), "NaN bounds", [](Mesh* m) { m[0].bounds_max[1] = static_cast<float>(kNan); });
  mesh(Code("E4012"), "infinite bounds",
       [](Mesh* m) { m[0].bounds_max[1] = static_cast<float>(kInfinity); });
  mesh(Code("E4012"), "bounds the wrong way round", [](Mesh* m) { m[0].bounds_min[2] = 2; });
  mesh(Code("E4013"), "bounds that leave a vertex out", [](Mesh* m) { m[0].bounds_max[0] = 0.5; });
  add.changed(Code("E4010"), "normals fewer than positions",
              [](OpenPan& f) { f.resize_section(SectionKind::normals, 7); });
}

void arrays(Collection& add) {
  const auto vertex = [&](Code code, const char* what, SectionKind kind, Float3 value) {
    add.changed(code, what, [&](OpenPan& f) { f.at<Float3>(kind, 6) = value; });
  };
  const auto nan = static_cast<float>(kNan), infinity = static_cast<float>(kInfinity);
  vertex(Code("E4012"), "a NaN position", SectionKind::positions, {0, nan, 0});
  vertex(Code("E4012"), "an infinite position", SectionKind::positions, {0, 0, infinity});
  vertex(Code("E4013"), "a position outside its bounds", SectionKind::positions, {0, 0, 1e-30f});
  vertex(Code("E4012"), "a normal of zero", SectionKind::normals, {0, 0, 0});
  vertex(Code("E4012"), "a normal 1e-4 too long", SectionKind::normals, {0, 0, 1.0001f});
  vertex(Code("E4012"), "a NaN normal", SectionKind::normals, {0, 0, nan});
  vertex(Code("E4012"), "a normal whose square overflows", SectionKind::normals, {0, 0, 1e38f});
  add.changed(Code("E4012"), "a NaN texcoord",
              [&](OpenPan& f) { f.at<Float2>(SectionKind::texcoords, 3).y = nan; });
  add.changed(Code("E4012"), "a negative colour",
              [](OpenPan& f) { f.at<Float3>(SectionKind::colors, 3).z = -1e-30f; });
  add.changed(Code("E4012"), "an infinite colour",
              [&](OpenPan& f) { f.at<Float3>(SectionKind::colors, 0).x = infinity; });
  add.changed(Code("E4010"), "an index past the last vertex",
              [](OpenPan& f) { f.at<std::uint16_t>(SectionKind::indices, 11) = 4; });
  add.changed(Code("E4010"), "an index of 0xffff",
              [](OpenPan& f) { f.at<std::uint16_t>(SectionKind::indices, 12) = 0xffff; });
  add.changed(Code("E4012"), "padding between runs of indices",
              [](OpenPan& f) { f.at<std::uint8_t>(SectionKind::indices, 30) = 1; });
  add.changed(Code("E4012"), "the last byte of padding between runs of indices",
              [](OpenPan& f) { f.at<std::uint8_t>(SectionKind::indices, 31) = 1; });
}

void tables(Collection& add) {
  const auto instance = [&](const char* what, const std::function<void(Instance&)>& change) {
    add.changed(Code("E4010"), what,
                [&](OpenPan& f) { change(f.at<Instance>(SectionKind::instances, 1)); });
  };
  instance("a node past the end", [](Instance& i) { i.node = 3; });
  instance("a mesh past the end", [](Instance& i) { i.mesh = 0xffffffffu; });
  instance("a material past the end", [](Instance& i) { i.material = 2; });
  instance("a texture past the end", [](Instance& i) { i.texture = 1; });
  instance("a texture on a mesh without texcoords", [](Instance& i) { i.mesh = 0; });
  instance("a texture of -2", [](Instance& i) { i.texture = -2; });
  const auto material = [&](Code code, const char* what,
                            const std::function<void(Material&)>& change) {
    add.changed(code, what, [&](OpenPan& f) { change(f.at<Material>(SectionKind::materials, 0)); });
  };
  material(Code("E4012"), "a NaN colour",
           [](Material& m) { m.diffuse[1] = static_cast<float>(kNan); });
  material(Code("E4012"), "a negative weight", [](Material& m) { m.weight_s = -0.5f; });
  material(Code("E4012"), "a refractive index of zero", [](Material& m) { m.refract[2] = 0; });
  material(Code("E4012"), "a colour that overflows",
           [](Material& m) { m.finger_color[0] = 2e38f; });
  material(Code("E4012"), "a number that overflows",
           [](Material& m) { m.albedo_deficit[3] = -2e12f; });
  material(Code("E4012"), "a slope of zero", [](Material& m) { m.cook[1] = 0; });
  material(Code("E4012"), "an unknown diffuse BRDF", [](Material& m) { m.diffuse_brdf = 5; });
  material(Code("E4012"), "an unknown specular BRDF",
           [](Material& m) { m.specular_brdf = 0x80000000u; });
  material(Code("E4012"), "a reserved word of a material", [](Material& m) { m.reserved_b = 1; });
  material(Code("E4010"), "a material's name", [](Material& m) { m.name = 1u << 31; });
  const auto texture = [&](Code code, const char* what,
                           const std::function<void(Texture&)>& change) {
    add.changed(code, what, [&](OpenPan& f) { change(f.at<Texture>(SectionKind::textures, 0)); });
  };
  texture(Code("E4010"), "an offset of texels near 2^64", [](Texture& t) { t.offset = kHuge - 3; });
  texture(Code("E4010"), "texels of another length", [](Texture& t) { t.bytes = kHuge; });
  texture(Code("E4010"), "a texture larger than its texels", [](Texture& t) { t.width = 16384; });
  texture(Code("E4012"), "a texture without width", [](Texture& t) { t.width = 0; });
  texture(Code("E4012"), "a texture of 2^32 - 1 rows", [](Texture& t) { t.height = 0xffffffffu; });
  texture(Code("E4012"), "an unknown flag of a texture", [](Texture& t) { t.flags = 2; });
  add.changed(Code("E4010"), "texels that no texture has", [](OpenPan& f) {
    f.resize_section(SectionKind::textures, 0);
    f.resize_section(SectionKind::decals, 0);
    f.at<Instance>(SectionKind::instances, 1).texture = -1;
  });
  add.changed(Code("E4010"), "a frame at no node",
              [](OpenPan& f) { f.at<Frame>(SectionKind::frames, 0).node = 3; });
  add.changed(Code("E4012"), "a frame that is not turned by a unit quaternion",
              [](OpenPan& f) { f.at<Frame>(SectionKind::frames, 0).rotation[1] = 0.1; });
  add.changed(Code("E4010"), "a source fewer than instances",
              [](OpenPan& f) { f.resize_section(SectionKind::sources, 1); });
  add.changed(Code("E4010"), "a source in no file",
              [](OpenPan& f) { f.at<Source>(SectionKind::sources, 0).file = 99; });
  add.changed(Code("E4012"), "two build records",
              [](OpenPan& f) { f.resize_section(SectionKind::build, 2); });
  add.changed(Code("E4012"), "no build record",
              [](OpenPan& f) { f.resize_section(SectionKind::build, 0); });
  add.changed(Code("E4012"), "an input that the build identity does not know",
              [](OpenPan& f) { f.at<Input>(SectionKind::inputs, 0).hash[1] ^= 1; });
}

void needs(Collection& add) {
  add.changed(Code("E4012"), "two needs",
              [](OpenPan& f) { f.resize_section(SectionKind::budget, 2); });
  const auto budget = [&](const char* what, const std::function<void(Budget&)>& change) {
    add.changed(Code("E4012"), what,
                [&](OpenPan& f) { change(f.at<Budget>(SectionKind::budget, 0)); });
  };
  budget("a negative tolerance", [](Budget& n) { n.tolerance = -1e-300; });
  budget("a NaN range", [](Budget& n) { n.nearest = kNan; });
  budget("an infinite IFOV", [](Budget& n) { n.ifov = kInfinity; });
  budget("a reserved word of a budget", [](Budget& n) { n.reserved[1] = 1; });
  add.changed(Code("E4010"), "a budget of a mesh fewer than meshes",
              [](OpenPan& f) { f.resize_section(SectionKind::mesh_tolerances, 1); });
  add.changed(Code("E4010"), "a budget of a mesh more than meshes",
              [](OpenPan& f) { f.resize_section(SectionKind::mesh_tolerances, 3); });
  add.changed(Code("E4012"), "an unknown reason",
              [](OpenPan& f) { f.at<MeshTolerance>(SectionKind::mesh_tolerances, 1).reason = 7; });
  add.changed(Code("E4012"), "an infinite tolerance", [](OpenPan& f) {
    f.at<MeshTolerance>(SectionKind::mesh_tolerances, 1).tolerance = kInfinity;
  });
}

void ground_truth(Collection& add) {
  const auto keypoint = [&](Code code, const char* what,
                            const std::function<void(Keypoint&)>& change) {
    add.changed(code, what, [&](OpenPan& f) { change(f.at<Keypoint>(SectionKind::keypoints, 1)); });
  };
  keypoint(Code("E4010"), "a keypoint at no node", [](Keypoint& k) { k.node = 3; });
  keypoint(Code("E4010"), "a keypoint's name", [](Keypoint& k) { k.name = 99; });
  keypoint(Code("E4012"), "a NaN keypoint", [](Keypoint& k) { k.position[2] = kNan; });
  keypoint(Code("E4012"), "a keypoint whose place in the world overflows",
           [](Keypoint& k) { k.position[2] = 1.7e308; });
  const auto decal = [&](Code code, const char* what, const std::function<void(Decal&)>& change) {
    add.changed(code, what, [&](OpenPan& f) { change(f.at<Decal>(SectionKind::decals, 1)); });
  };
  decal(Code("E4010"), "a decal on no instance", [](Decal& d) { d.instance = 3; });
  decal(Code("E4010"), "a decal without a texture", [](Decal& d) { d.texture = 1; });
  decal(Code("E4010"), "a decal's name", [](Decal& d) { d.name = 0x7fffffffu; });
  decal(Code("E4012"), "a decal that is not turned by a unit quaternion",
        [](Decal& d) { d.rotation[3] = 1e-3; });
  decal(Code("E4012"), "a decal of no width", [](Decal& d) { d.width = 0; });
  decal(Code("E4012"), "a decal of negative height", [](Decal& d) { d.height = -1; });
  decal(Code("E4012"), "a decal of no depth", [](Decal& d) { d.depth = 0; });
  decal(Code("E4012"), "a decal of infinite depth", [](Decal& d) { d.depth = kInfinity; });
  decal(Code("E4012"), "a NaN place of a decal", [](Decal& d) { d.origin[0] = kNan; });
  decal(Code("E4012"), "a reserved word of a decal", [](Decal& d) { d.reserved = 1; });
}

void maps(Collection& add) {
  const auto map = [&](Code code, const char* what, std::size_t material,
                       const std::function<void(Material&)>& change) {
    add.changed(code, what,
                [&](OpenPan& f) { change(f.at<Material>(SectionKind::materials, material)); });
  };
  // the material of the square, which has texcoords: nothing but the number is wrong
  map(Code("E4010"), "an albedo map past the end", 1, [](Material& m) { m.albedo_map = 1; });
  map(Code("E4010"), "a normal map of -2", 1, [](Material& m) { m.normal_map = -2; });
  map(Code("E4010"), "a roughness map past the end", 1, [](Material& m) { m.roughness_map = 9; });
  map(Code("E4010"), "a reflectance map past the end", 1,
      [](Material& m) { m.reflectance_map = 1; });
  map(Code("E4012"), "a negative reflectance", 1, [](Material& m) { m.reflectance[2] = -0.1f; });
  map(Code("E4010"), "a cutout map past the end", 1,
      [](Material& m) { m.cutout_map = 0x7fffffff; });
  map(Code("E4012"), "a threshold above 1", 1, [](Material& m) { m.cutout_threshold = 1.0001f; });
  map(Code("E4012"), "a repeat that is not finite", 1,
      [](Material& m) { m.map_repeat[1] = static_cast<float>(kInfinity); });
  map(Code("E4012"), "cells along one axis only", 1, [](Material& m) { m.cell_count[0] = 4; });
  map(Code("E4012"), "more cells than float can place", 1,
      [](Material& m) { m.cell_count[0] = m.cell_count[1] = 1e7f; });
  map(Code("E4012"), "a gap as wide as the pitch of cells", 1,
      [](Material& m) { m.cell_gap[1] = 1; });
  map(Code("E4012"), "fingers that cover a cell", 1, [](Material& m) { m.finger_width = 1; });
  map(Code("E4012"), "fingers without number", 1, [](Material& m) { m.fingers = 1e9f; });
  // the material of the tetrahedron, which has none
  map(Code("E4010"), "cells on a mesh without texcoords", 0,
      [](Material& m) { m.cell_count[0] = m.cell_count[1] = 2; });
  map(Code("E4010"), "an albedo map on a mesh without texcoords", 0,
      [](Material& m) { m.albedo_map = 0; });
  map(Code("E4010"), "a normal map on a mesh without texcoords", 0,
      [](Material& m) { m.normal_map = 0; });
  map(Code("E4010"), "a roughness map on a mesh without texcoords", 0,
      [](Material& m) { m.roughness_map = 0; });
  map(Code("E4010"), "a reflectance map on a mesh without texcoords", 0,
      [](Material& m) { m.reflectance_map = 0; });
  map(Code("E4010"), "a cutout map on a mesh without texcoords", 0,
      [](Material& m) { m.cutout_map = 0; });
}

void strings(Collection& add) {
  const auto offsets = [&](const char* what, const std::function<void(std::uint32_t*)>& change) {
    add.changed(Code("E4010"), what,
                [&](OpenPan& f) { change(&f.at<std::uint32_t>(SectionKind::string_offsets, 0)); });
  };
  offsets("a string that ends before it begins", [](std::uint32_t* o) { o[3] = o[2] - 1; });
  offsets("a string past the end", [](std::uint32_t* o) { o[4] = 0xffffffffu; });
  offsets("a first string with text", [](std::uint32_t* o) { o[1] = 1; });
  offsets("strings that begin late", [](std::uint32_t* o) { o[0] = 1; });
  add.changed(Code("E4010"), "text behind the last string", [](OpenPan& f) {
    f.resize_section(SectionKind::string_bytes, f.entry(SectionKind::string_bytes).count + 1);
  });
  add.changed(Code("E4010"), "no strings at all",
              [](OpenPan& f) { f.resize_section(SectionKind::string_offsets, 1); });
  const auto text = [&](const char* what, std::string_view bytes) {
    add.changed(Code("E4014"), what, [&](OpenPan& f) {
      // over the first letters of the version
      std::memcpy(&f.at<char>(SectionKind::string_bytes, 0), bytes.data(), bytes.size());
    });
  };
  text("a NUL", std::string_view("\0", 1));
  text("a continuation byte alone", "\x80");
  text("an overlong slash", "\xc0\xaf");
  text("a surrogate", "\xed\xa0\x80");
  text("a character above U+10FFFF", "\xf4\x90\x80\x80");
  text("a sequence that is cut short", "\xe2\x82z");
  add.changed(Code("E4014"), "a string that ends inside a character", [](OpenPan& f) {
    auto* o = &f.at<std::uint32_t>(SectionKind::string_offsets, 0);
    // the end of a string moves into the two bytes of the ä of the next but one
    for (std::size_t i = 1; i + 1 < f.entry(SectionKind::string_offsets).count; ++i)
      if (f.at<std::uint8_t>(SectionKind::string_bytes, o[i] + 2) == 0xc3) o[i] += 3;
  });
  add.changed(Code("E4012"), "a path of 5000 bytes", [](OpenPan& f) {
    pan::Contents contents = small_contents();
    contents.meshes[0].name = std::string(5000, 'x');
    f = OpenPan(pan::write_to_memory(contents));
    f.at<Input>(SectionKind::inputs, 0).path = f.at<Mesh>(SectionKind::meshes, 0).name;
    // the identity is right, so that the length alone is wrong
    contents.inputs[0].path = contents.meshes[0].name;
    const Hash128 id = pan::build_identity(contents.inputs, contents.version, contents.options);
    f.header().build_id[0] = id.low;
    f.header().build_id[1] = id.high;
  });
}

}  // namespace

std::vector<DamagedPan> damaged_pans() {
  Collection add;
  frame_of_file(add);
  directory(add);
  sections(add);
  record_sizes(add);
  compression(add);
  nodes(add);
  meshes(add);
  arrays(add);
  tables(add);
  needs(add);
  ground_truth(add);
  maps(add);
  strings(add);
  return add.take();
}

std::vector<std::pair<Code, std::vector<std::byte>>> damaged_examples() {
  std::vector<std::pair<Code, std::vector<std::byte>>> examples;
  for (DamagedPan& damaged : damaged_pans()) {
    bool seen = false;
    for (const auto& example : examples) seen |= example.first == damaged.code;
    if (!seen) examples.emplace_back(damaged.code, std::move(damaged.bytes));
  }
  return examples;
}

}  // namespace panwright::support
