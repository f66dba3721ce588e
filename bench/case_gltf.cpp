// Reading GLB files of a million triangles: plain, quantised, meshopt and Draco, beside the error
// of their positions.
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "base/file.h"
#include "bench/bench.h"
#include "geometry/tessellate/tessellate.h"
#include "importers/import.h"

namespace panwright::bench::case_gltf {

namespace {

// A unit sphere in single precision.
struct Ball {
  std::vector<float> positions;  // 3*V
  std::vector<float> normals;    // 3*V
  std::vector<std::uint32_t> indices;
  std::size_t vertices() const { return positions.size() / 3; }
  std::size_t triangles() const { return indices.size() / 3; }
};

Ball make_ball(std::uint32_t quads) {
  geometry::Sphere sphere;
  sphere.counts = geometry::SphereCounts{quads, quads};
  DiagnosticLog log;
  const auto mesh = geometry::tessellated(sphere, {}, {}, log);
  if (!mesh) std::abort();
  Ball ball;
  for (const Vec3& p : mesh->positions)
    for (int k = 0; k < 3; ++k) ball.positions.push_back(static_cast<float>(p[k]));
  for (const Vec3& n : mesh->normals)
    for (int k = 0; k < 3; ++k) ball.normals.push_back(static_cast<float>(n[k]));
  for (const auto& t : mesh->triangles) ball.indices.insert(ball.indices.end(), t.begin(), t.end());
  return ball;
}

// A GLB under construction.
struct Glb {
  std::string binary;
  std::string views;

  template <class T>
  void add(const std::vector<T>& data, const std::string& more = {}) {
    binary.resize((binary.size() + 3) / 4 * 4);
    const std::size_t at = binary.size(), size = data.size() * sizeof(T);
    binary.resize(at + size);
    std::memcpy(binary.data() + at, data.data(), size);
    views += fmt::format("{}{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}{}}}",
                         views.empty() ? "" : ",", at, size, more);
  }

  std::string file(const std::string& rest, std::size_t more_buffers = 0) const {
    std::string text = fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"scene":0,)"
        R"("buffers":[{{"byteLength":{}}}{}],"bufferViews":[{}],{}}})",
        binary.size(),
        more_buffers > 0 ? fmt::format(R"(,{{"byteLength":{},"extensions":)"
                                       R"({{"EXT_meshopt_compression":{{"fallback":true}}}}}})",
                                       more_buffers)
                         : "",
        views, rest);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string body = binary;
    body.resize((body.size() + 3) / 4 * 4);
    std::string out = "glTF";
    const auto word = [&](std::size_t value) {
      for (int i = 0; i < 4; ++i) out += static_cast<char>(value >> (8 * i) & 255);
    };
    word(2);
    word(28 + text.size() + body.size());
    word(text.size());
    out += "JSON" + text;
    word(body.size());
    return out + std::string("BIN\0", 4) + body;
  }
};

constexpr const char* kAccessors =
    R"("accessors":[{{"bufferView":0,"componentType":{3},"normalized":{4},"count":{0},"type":"VEC3","min":[-1,-1,-1],"max":[1,1,1]}},)"
    R"({{"bufferView":1,"componentType":{5},"normalized":{4},"count":{0},"type":"VEC3"}},)"
    R"({{"bufferView":2,"componentType":5125,"count":{1},"type":"SCALAR"}}],)"
    R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1}},"indices":2}}]}}]{2})";

std::string plain(const Ball& ball) {
  Glb glb;
  glb.add(ball.positions);
  glb.add(ball.normals);
  glb.add(ball.indices);
  return glb.file(
      fmt::format(kAccessors, ball.vertices(), ball.indices.size(), "", 5126, "false", 5126));
}

std::vector<std::int16_t> in_shorts(const std::vector<float>& list) {
  std::vector<std::int16_t> out;
  for (std::size_t i = 0; i < list.size(); ++i) {
    out.push_back(static_cast<std::int16_t>(std::lround(list[i] * 32767)));
    if (i % 3 == 2) out.push_back(0);
  }
  return out;
}

constexpr const char* kQuantised =
    R"(,"extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"])";

std::string quantised(const Ball& ball) {
  Glb glb;
  glb.add(in_shorts(ball.positions), R"(,"byteStride":8)");
  glb.add(in_shorts(ball.normals), R"(,"byteStride":8)");
  glb.add(ball.indices);
  return glb.file(fmt::format(kAccessors, ball.vertices(), ball.indices.size(), kQuantised, 5122,
                              "true", 5122));
}

std::string packed_by_meshopt(const Ball& ball) {
  Glb glb;
  std::string views;
  std::size_t at = 0;
  const auto add = [&](const std::vector<unsigned char>& stream, std::size_t stride,
                       std::size_t count, const char* mode) {
    glb.binary.resize((glb.binary.size() + 3) / 4 * 4);
    const bool vertices = mode[0] == 'A';
    views += fmt::format(
        R"({}{{"buffer":1,"byteOffset":{},"byteLength":{}{},"extensions":{{"EXT_meshopt_compression":{{"buffer":0,"byteOffset":{},"byteLength":{},"byteStride":{},"count":{},"mode":"{}"}}}}}})",
        views.empty() ? "" : ",", at, stride * count,
        vertices ? fmt::format(",\"byteStride\":{}", stride) : "", glb.binary.size(), stream.size(),
        stride, count, mode);
    at += stride * count;
    glb.binary.append(reinterpret_cast<const char*>(stream.data()), stream.size());
  };
  for (const auto* list : {&ball.positions, &ball.normals}) {
    const std::vector<std::int16_t> shorts = in_shorts(*list);
    std::vector<unsigned char> stream(meshopt_encodeVertexBufferBound(ball.vertices(), 8));
    stream.resize(meshopt_encodeVertexBuffer(stream.data(), stream.size(), shorts.data(),
                                             ball.vertices(), 8));
    add(stream, 8, ball.vertices(), "ATTRIBUTES");
  }
  std::vector<unsigned char> stream(
      meshopt_encodeIndexBufferBound(ball.indices.size(), ball.vertices()));
  stream.resize(meshopt_encodeIndexBuffer(stream.data(), stream.size(), ball.indices.data(),
                                          ball.indices.size()));
  add(stream, 4, ball.indices.size(), "TRIANGLES");
  glb.views = views;
  return glb.file(
      fmt::format(kAccessors, ball.vertices(), ball.indices.size(),
                  R"(,"extensionsUsed":["KHR_mesh_quantization","EXT_meshopt_compression"],)"
                  R"("extensionsRequired":["KHR_mesh_quantization","EXT_meshopt_compression"])",
                  5122, "true", 5122),
      at);
}

std::vector<char> draco_stream(const Ball& ball, int bits) {
  draco::Mesh mesh;
  mesh.SetNumFaces(ball.triangles());
  mesh.set_num_points(static_cast<std::uint32_t>(ball.vertices()));
  for (const auto kind : {draco::GeometryAttribute::POSITION, draco::GeometryAttribute::NORMAL}) {
    const auto& list = kind == draco::GeometryAttribute::POSITION ? ball.positions : ball.normals;
    draco::GeometryAttribute attribute;
    attribute.Init(kind, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
    const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(ball.vertices()));
    for (std::uint32_t i = 0; i < ball.vertices(); ++i)
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &list[3 * i]);
  }
  for (std::uint32_t i = 0; i < ball.triangles(); ++i)
    mesh.SetFace(draco::FaceIndex(i), {draco::PointIndex(ball.indices[3 * i]),
                                       draco::PointIndex(ball.indices[3 * i + 1]),
                                       draco::PointIndex(ball.indices[3 * i + 2])});
  draco::Encoder encoder;
  encoder.SetSpeedOptions(5, 5);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, bits);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 10);
  draco::EncoderBuffer out;
  if (!encoder.EncodeMeshToBuffer(mesh, &out).ok()) std::abort();
  return {out.data(), out.data() + out.size()};
}

std::string packed_by_draco(const Ball& ball, const std::vector<char>& stream) {
  Glb glb;
  glb.add(stream);
  return glb.file(fmt::format(
      R"("extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"],)"
      R"("accessors":[{{"componentType":5126,"count":{0},"type":"VEC3","min":[-1,-1,-1],"max":[1,1,1]}},)"
      R"({{"componentType":5126,"count":{0},"type":"VEC3"}},{{"componentType":5125,"count":{1},"type":"SCALAR"}}],)"
      R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1}},"indices":2,)"
      R"("extensions":{{"KHR_draco_mesh_compression":{{"bufferView":0,"attributes":{{"POSITION":0,"NORMAL":1}}}}}}}}]}}])",
      ball.vertices(), ball.indices.size()));
}

importers::Imported imported(const std::vector<importers::MemoryFile>& files) {
  DiagnosticLog log;
  auto out = importers::import_memory(files, {}, log);
  if (!out || log.has_errors()) {
    fmt::print(stderr, "{}", to_text(log));
    std::abort();
  }
  return *std::move(out);
}

// How far the vertices lie from the sphere they stand on.
double error_of(const importers::Imported& model) {
  double worst = 0;
  for (const Vec3& p : std::get<geometry::MeshShape>(model.scene.shapes[0])->positions)
    worst = std::max(worst, std::fabs(glm::length(p) - 1));
  return worst;
}

struct Subject {
  std::string name;
  std::vector<importers::MemoryFile> files;
  double must_error;
};

std::size_t decode_alone(const std::vector<char>& stream) {
  draco::DecoderBuffer buffer;
  buffer.Init(stream.data(), stream.size());
  draco::Decoder decoder;
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) std::abort();
  return mesh.value()->num_faces();
}

void add_draco_errors(Context& context, const Ball& ball) {
  for (const int bits : {8, 10, 12, 14, 16}) {
    const std::vector<char> stream = draco_stream(ball, bits);
    const std::vector<importers::MemoryFile> files = {{"x.glb", packed_by_draco(ball, stream)}};
    const Timing timing = timed([&] { imported(files); }, 3);
    // half a step of the grid along each axis
    const double bound = std::sqrt(3.0) / std::ldexp(1.0, bits) * 1.01 + 1e-7;
    Row row{.case_name = "gltf",
            .setting = fmt::format(
                "Draco, {} bits, {} triangles, {:.2f} bytes/triangle", bits, ball.triangles(),
                static_cast<double>(stream.size()) / static_cast<double>(ball.triangles())),
            .speed_unit = "Mtri/s",
            .error = error_of(imported(files)),
            .error_unit = "m",
            .reference = "the unit sphere that the vertices stand on",
            .reference_error = 6e-8,
            .must_error = bound};
    set_rate(row, timing, 1e-6 * static_cast<double>(ball.triangles()));
    context.add(row);
  }
}

void run(Context& context) {
  const Ball ball = make_ball(context.quick() ? 70 : 708);
  const auto megatriangles = 1e-6 * static_cast<double>(ball.triangles());
  const std::vector<char> stream = draco_stream(ball, 14);
  const std::vector<Subject> subjects = {
      {"plain", {{"x.glb", plain(ball)}}, 1.2e-7},
      {"quantised to 16 bits", {{"x.glb", quantised(ball)}}, 2.8e-5},
      {"meshopt, 16 bits", {{"x.glb", packed_by_meshopt(ball)}}, 2.8e-5},
      {"Draco, 14 bits", {{"x.glb", packed_by_draco(ball, stream)}}, 1.1e-4}};
  std::vector<Variant> variants;
  for (const Subject& subject : subjects)
    variants.push_back({subject.name, [&] { imported(subject.files); }});
  variants.push_back({"the library alone", [&] { decode_alone(stream); }});
  const std::filesystem::path assimp = "/usr/bin/assimp";
  const std::filesystem::path file = context.scratch() / "plain.glb";
  const bool has_assimp = std::filesystem::exists(assimp);
  if (has_assimp) {
    DiagnosticLog log;
    if (!write_file(file, as_bytes(subjects[0].files[0].bytes), log)) std::abort();
    variants.push_back({"assimp", [&] { run_program(assimp, {"info", file.string()}); }});
  } else {
    context.note("assimp is not installed: its row is missing");
  }
  const std::vector<Timing> timings = interleaved(variants, context.quick() ? 3 : 7);
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const bool ours = i < subjects.size();
    Row row{.case_name = "gltf",
            .setting = fmt::format("{}, {} triangles, {:.1f} ms", variants[i].setting,
                                   ball.triangles(), 1e3 * timings[i].median),
            .speed_unit = "Mtri/s",
            .error_unit = "m",
            .reference = ours ? "the unit sphere that the vertices stand on" : "not measured",
            .reference_error = 6e-8};
    if (ours) {
      row.setting +=
          fmt::format(", {:.1f} MB", 1e-6 * static_cast<double>(subjects[i].files[0].bytes.size()));
      row.error = error_of(imported(subjects[i].files));
      row.must_error = subjects[i].must_error;
    }
    if (i == 0 && !context.quick()) row.must = 10;
    if (i == 3) row.must = 0.8 * megatriangles / timings[4].median;
    set_rate(row, timings[i], megatriangles);
    context.add(row);
  }
  add_draco_errors(context, make_ball(context.quick() ? 40 : 200));
}

const bool kAdded =
    add_case({"gltf", "reading GLB files, against the error of their positions", run});

}  // namespace

}  // namespace panwright::bench::case_gltf
