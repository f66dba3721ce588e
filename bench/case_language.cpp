// Level 1 of the language: expressions, parts and repeats, as a whole process.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "pan/model.h"

namespace panwright::bench::case_language {

namespace {

constexpr int kParameters = 20;
constexpr int kParts = 40;
constexpr int kShapesInPart = 10;
constexpr int kUses = 400;
constexpr int kRepeats = 800;
constexpr int kTransforms = 3370;
constexpr int kElements =
    kParameters + kParts * (1 + kShapesInPart) + kUses + 3 * kRepeats + 2 * kTransforms;
static_assert(kElements == 10'000);

// The value of parameter k, as the text below defines it.
double parameter(int k) { return k == 0 ? 0.25 : 0.5 * parameter(k - 1) + 0.003 * k; }

std::string language_pxn() {
  std::string text = "<pangu_model ver=\"1\" units=\"mm\">\n<param name=\"p0\" value=\"25cm\"/>\n";
  for (int k = 1; k < kParameters; ++k)
    text += fmt::format("<param name=\"p{}\" value=\"{{p{}/2 + {}*3mm}}\"/>\n", k, k - 1, k);
  for (int part = 0; part < kParts; ++part) {
    text += fmt::format("<part name=\"part{}\">\n", part);
    for (int i = 0; i < kShapesInPart; ++i)
      text += fmt::format("  <box size=\"{{p{}}} {} 20mm\" translate=\"0 0 {{{}*p1 + 5mm}}\"/>\n",
                          part % kParameters, 10 + i, i);
    text += "</part>\n";
  }
  for (int i = 0; i < kUses; ++i)
    text += fmt::format(
        "<use part=\"part{}\" translate=\"{{{}*p1}} {} 0\" rotate=\"0 0 {{{}*3deg}}\"/>\n",
        i % kParts, i % 20, 300 * (i / 20), i);
  for (int i = 0; i < kRepeats; ++i)
    text += fmt::format(
        "<repeat count=\"3\" var=\"k\" translate=\"0 {} {{k*p2}}\" rotate=\"{{k*120deg}} 0 0\">\n"
        "  <box size=\"{{p3}} {{p4}} {{p5*(k+1)}}\"/>\n"
        "  <keypoint name=\"k{}_{{k}}\" at=\"{{p1 + k*sin(30deg)}} 0 2cm\"/>\n</repeat>\n",
        100 * i, i);
  for (int i = 0; i < kTransforms; ++i)
    text += fmt::format(
        "<transform translate=\"{} {{{}*p6}} -1m\" scale=\"{{1 + 1/{}}}\">\n"
        "  <box size=\"{} 10 1cm\"/>\n</transform>\n",
        100 * (i % 60), i / 60, i + 1, 10 + i % 50);
  return text + "</pangu_model>\n";
}

// The largest distance of a keypoint from where the text puts it, worked out here.
double worst_keypoint(const pan::Model& model) {
  const auto world = model.world_from_nodes();
  double worst = model.keypoints().size() == 3 * kRepeats ? 0 : 1e30;
  for (std::size_t i = 0; i < model.keypoints().size(); ++i) {
    const auto& point = model.keypoints()[i];
    const Vec3 found =
        Vec3(world[point.node] * Vec4(point.position[0], point.position[1], point.position[2], 1));
    const int repeat = static_cast<int>(i) / 3;
    const int k = static_cast<int>(i) % 3;
    const double angle = k * 2 * kPi / 3;
    const Vec3 expected(parameter(1) + 0.5 * k, 0.1 * repeat - 0.02 * std::sin(angle),
                        k * parameter(2) + 0.02 * std::cos(angle));
    worst = std::max(worst, glm::length(found - expected));
  }
  return worst;
}

void run(Context& context) {
  const std::filesystem::path tool = context.program("panwright");
  if (tool.empty()) {
    context.note("panwright is not built beside this program: nothing measured");
    return;
  }
  const auto input = write_scratch(context, "language.pxn", language_pxn());
  const auto output = context.scratch() / "language.pan";
  const auto compile = [&] {
    return run_program(tool, {"compile", input.string(), "-o", output.string(), "--quiet"});
  };
  DiagnosticLog log;
  if (compile() != 0) {
    context.note("the level 1 file could not be compiled");
    return;
  }
  const Timing timing = timed([&] { compile(); }, context.quick() ? 3 : 31);
  const auto model = pan::Model::load(output, log);
  if (!model) {
    context.note("the pan file of the level 1 file is not sound");
    return;
  }
  Row row{.case_name = "language",
          .setting =
              fmt::format("process level=1 elements={} nodes={}", kElements, model->nodes().size()),
          .speed_unit = "ms",
          .error = worst_keypoint(*model),
          .error_unit = "m",
          .reference = "keypoints by hand-written formulas, coordinates to 80 m",
          .reference_error = 1e-14,
          .must = 150,
          .must_is_least = false,
          .must_error = 1e-12};
  set_time(row, timing, 1e3);
  context.add(row);
}

const bool kAdded =
    add_case({"language", "level 1: expressions, parts and repeats as a whole process", run});

}  // namespace

}  // namespace panwright::bench::case_language
