// Reading of VRML texts, in the process, beside a plain sweep over their numbers and Coin.
#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "bench/cad_files.h"
#include "importers/import.h"
#include "importers/vrml/internal/reader_context.h"
#ifdef PANWRIGHT_COIN
#include <Inventor/SoDB.h>
#include <Inventor/SoInput.h>
#include <Inventor/VRMLnodes/SoVRMLCoordinate.h>
#include <Inventor/VRMLnodes/SoVRMLIndexedFaceSet.h>
#include <Inventor/VRMLnodes/SoVRMLShape.h>
#include <Inventor/nodes/SoSeparator.h>
#endif

namespace panwright::bench::case_vrml {

namespace {

using importers::MemoryFile;

std::vector<double> swept(const std::string& text) {
  std::vector<double> out;
  out.reserve(text.size() / 6);
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end) {
    double value = 0;
    const auto result = std::from_chars(at, end, value);
    if (result.ec == std::errc()) {
      out.push_back(value);
      at = result.ptr;
    } else {
      ++at;
    }
  }
  return out;
}

// The points of the first IndexedFaceSet, as the parser reads them.
std::vector<double> points_of(const std::string& text) {
  const std::vector<MemoryFile> none;
  const auto files = importers::files_in_memory(none, 1);
  const importers::Options options;
  DiagnosticLog log;
  importers::vrml::ReaderContext context(*files, options, log);
  auto bytes = std::shared_ptr<const std::string>(std::shared_ptr<void>(), &text);
  auto* document = context.open({"band.wrl", "band.wrl", bytes, {}});
  if (document == nullptr || document->nodes.empty()) return {};
  const auto points = document->nodes.back()->node("geometry")->node("coord")->numbers("point");
  return {points.begin(), points.end()};
}

double off(const Band& band, const std::vector<double>& points) {
  if (points.size() != 3 * band.vertices()) return 1;
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); i += 3)
    worst = std::max(worst, band.off({points[i], points[i + 1], points[i + 2]}));
  return worst;
}

std::unique_ptr<importers::Imported> scene_of(const std::string& text) {
  const MemoryFile file{"band.wrl", text};
  DiagnosticLog log;
  auto imported = importers::import_memory(std::span(&file, 1), {}, log);
  if (!imported || log.has_errors()) return nullptr;
  return std::make_unique<importers::Imported>(std::move(*imported));
}

double off(const Band& band, const importers::Imported* imported) {
  if (imported == nullptr || imported->scene.shapes.size() != 1) return 1;
  const auto* mesh = std::get_if<geometry::MeshShape>(&imported->scene.shapes[0]);
  if (mesh == nullptr || (*mesh)->triangles.size() != band.triangles()) return 1;
  double worst = 0;
  for (const Vec3& p : (*mesh)->positions) worst = std::max(worst, band.off(p));
  return worst;
}

// Many small nodes, as in a file of parts.
std::string parts(std::size_t bytes) {
  std::string out = "#VRML V2.0 utf8\n";
  for (std::size_t i = 0; out.size() < bytes; ++i)
    out += fmt::format(
        "DEF part{0} Transform {{\n  translation {0}.25 {1} -0.5\n  rotation 0 1 0 0.{1}\n"
        "  children [\n    Shape {{\n      appearance Appearance {{\n        material Material {{ "
        "diffuseColor 0.{1} 0.5 0.25 shininess 0.5 }}\n      }}\n      geometry IndexedFaceSet {{\n"
        "        coord Coordinate {{ point [ 0 0 {0}, 1 0 0, 1 1 0, 0 1 0.5 ] }}\n"
        "        coordIndex [ 0, 1, 2, 3, -1 ]\n      }}\n    }}\n  ]\n}}\n",
        i, i % 10);
  return out;
}

double missing_parts(const std::string& text, const importers::Imported* imported) {
  std::size_t written = 0;
  for (std::size_t at = 0; (at = text.find("DEF part", at)) != std::string::npos; ++at) ++written;
  if (imported == nullptr) return 1;
  double wrong = std::fabs(static_cast<double>(imported->scene.instances.size()) -
                           static_cast<double>(written));
  for (std::size_t i = 1; i < imported->scene.nodes.size(); i += 2) {
    const Vec3 at = imported->scene.nodes[i].parent_from_node.translation;
    wrong += at.x == static_cast<double>(i / 2) + 0.25 ? 0 : 1;
  }
  return wrong;
}

#ifdef PANWRIGHT_COIN
std::vector<double> coin_points(const std::string& text) {
  SoInput input;
  input.setBuffer(text.data(), text.size());
  SoSeparator* root = SoDB::readAll(&input);
  if (root == nullptr) return {};
  root->ref();
  std::vector<double> out;
  for (int i = 0; i < root->getNumChildren(); ++i) {
    if (!root->getChild(i)->isOfType(SoVRMLShape::getClassTypeId())) continue;
    const auto* shape = static_cast<const SoVRMLShape*>(root->getChild(i));
    const auto* faces = static_cast<const SoVRMLIndexedFaceSet*>(shape->geometry.getValue());
    const auto* node = static_cast<const SoVRMLCoordinate*>(faces->coord.getValue());
    for (int p = 0; p < node->point.getNum(); ++p)
      for (int k = 0; k < 3; ++k) out.push_back(static_cast<double>(node->point[p][k]));
  }
  root->unref();
  return out;
}
#endif

void run(Context& context) {
  const Band band(context.quick() ? 40 : 708);
  const std::string text = band.vrml();
  const std::string small = parts(context.quick() ? 100'000 : 10'000'000);
  std::vector<double> sweep;
  std::vector<double> points;
  std::unique_ptr<importers::Imported> scene;
  std::unique_ptr<importers::Imported> small_scene;
  std::vector<Variant> variants = {
      {"numbers alone, by from_chars", [&] { sweep = swept(text); }},
      {"one face set: text", [&] { points = points_of(text); }},
      {"one face set: scene", [&] { scene = scene_of(text); }},
      {"small parts: scene", [&] { small_scene = scene_of(small); }},
  };
#ifdef PANWRIGHT_COIN
  SoDB::init();
  std::vector<double> theirs;
  variants.push_back({"one face set: text, by Coin", [&] { theirs = coin_points(text); }});
#else
  context.note("Coin is not installed: no peer");
#endif
  const std::vector<Timing> timings = interleaved(variants, context.runs());
  const double sweep_error = sweep.size() >= 3 * band.vertices() + 4 * band.triangles() ? 0.0 : 1.0;
  const double errors[] = {sweep_error, off(band, points), off(band, scene.get()),
                           missing_parts(small, small_scene.get()),
#ifdef PANWRIGHT_COIN
                           off(band, theirs)
#endif
  };
  const double musts[] = {0, 300, 0, 60, 0};
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const std::string& what = i == 3 ? small : text;
    Row row{.case_name = "vrml",
            .setting = fmt::format("{} MB={:.3g}", variants[i].setting,
                                   static_cast<double>(what.size()) * 1e-6),
            .speed_unit = "MB/s",
            .error = errors[i],
            .error_unit = i == 3   ? "parts"
                          : i == 0 ? "texts"
                                   : "m of 1 m",
            .reference = "the numbers written",
            .must = context.quick() ? 0 : musts[i],
            .must_error = i == 4 ? 1e-7 : 1e-300};
    set_rate(row, timings[i], static_cast<double>(what.size()) * 1e-6);
    context.add(row);
  }
}

const bool kAdded = add_case({"vrml", "texts of VRML to documents and scenes", run});

}  // namespace

}  // namespace panwright::bench::case_vrml
