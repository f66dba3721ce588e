// Opening and checking pan files of several sizes.
#include <fmt/core.h>

#include <bit>
#include <cstdlib>

#include "base/file.h"
#include "bench/bench.h"
#include "bench/scenes.h"
#include "compiler/compile.h"
#include "pan/diff.h"
#include "pan/model.h"

namespace panwright::bench::case_pan {

namespace {

// How many of `trials` damaged copies check() lets pass: one bit each, spread over the file.
int undetected(const std::vector<std::byte>& sound, int trials) {
  int passed = 0;
  std::vector<std::byte> bytes = sound;
  for (int i = 0; i < trials; ++i) {
    const std::size_t place = (2 * static_cast<std::size_t>(i) + 1) * bytes.size() /
                              (2 * static_cast<std::size_t>(trials));
    bytes[place] ^= std::byte{0x10};
    DiagnosticLog log;
    auto model = pan::Model::from_bytes(bytes, "damaged", log);
    passed += model.ok() && model->check(log);
    bytes[place] = sound[place];
  }
  return passed;
}

void run_size(Context& context, std::uint32_t side, int wrong) {
  const std::filesystem::path path = context.scratch() / "sphere.pan";
  DiagnosticLog log;
  compiler::Options options;
  const auto report =
      compiler::compile(sphere_scene({side, side}, lambert_material(0.8)), options, path, log);
  if (!report) {
    context.note("a sphere could not be compiled");
    return;
  }
  const auto open = [&] {
    DiagnosticLog inner;
    auto model = pan::Model::open(path, inner);
    if (!model) std::abort();
    return model;
  };
  auto kept = open();
  const std::vector<Timing> timings = interleaved({{"open", [&] { static_cast<void>(open()); }},
                                                   {"check",
                                                    [&] {
                                                      DiagnosticLog inner;
                                                      if (!kept->check(inner)) std::abort();
                                                    }}},
                                                  context.quick() ? 3 : 7);
  const double bytes = static_cast<double>(kept->bytes().size());
  Row row{.case_name = "pan",
          .setting = fmt::format("open size={:.3g} MB", 1e-6 * bytes),
          .speed_unit = "ms",
          .error = static_cast<double>(wrong),
          .error_unit = "damaged files accepted",
          .reference = "single bits flipped all over a smaller file of the kind",
          .must = 1,
          .must_is_least = false,
          .must_error = 0.5};
  set_time(row, timings[0], 1e3);
  context.add(row);
  row.setting = fmt::format("check size={:.3g} MB", 1e-6 * bytes);
  row.speed_unit = "GB/s";
  row.must = bytes > 1e9 ? 3 : 0;
  row.must_is_least = true;
  set_rate(row, timings[1], 1e-9 * bytes);
  context.add(row);
}

// The same model as it is and compressed: bytes, and the time to write and to load each.
void run_compressed(Context& context, std::uint32_t side) {
  DiagnosticLog log;
  const scene::Scene scene = sphere_scene({side, side}, lambert_material(0.8));
  compiler::Options packing;
  packing.storage.kind = pan::StorageForm::Kind::lossless;
  const auto plain = compiler::compiled(scene, {}, log);
  const auto packed = compiler::compiled(scene, packing, log);
  const auto plain_path = context.scratch() / "plain.pan",
             packed_path = context.scratch() / "z.pan";
  if (!plain || !packed || !write_file(plain_path, *plain, log) ||
      !write_file(packed_path, *packed, log)) {
    context.note("a sphere could not be compiled");
    return;
  }
  const auto load = [](const std::filesystem::path& path) {
    DiagnosticLog inner;
    auto model = pan::Model::load(path, inner);
    if (!model) std::abort();
    return *std::move(model);
  };
  const auto differences = pan::diff(load(plain_path), load(packed_path));
  const std::vector<Timing> timings =
      interleaved({{"plain", [&] { static_cast<void>(load(plain_path)); }},
                   {"compressed", [&] { static_cast<void>(load(packed_path)); }},
                   {"compile", [&] { static_cast<void>(compiler::compiled(scene, {}, log)); }},
                   {"compile and compress",
                    [&] { static_cast<void>(compiler::compiled(scene, packing, log)); }}},
                  context.quick() ? 3 : 7);
  const char* const settings[] = {"load stored=as it is", "load stored=compressed",
                                  "compile stored=as it is", "compile stored=compressed"};
  for (std::size_t i = 0; i < timings.size(); ++i) {
    Row row{.case_name = "pan",
            .setting = fmt::format("{} size={:.3g} MB file={:.3g} MB", settings[i],
                                   1e-6 * static_cast<double>(plain->size()),
                                   1e-6 * static_cast<double>((i % 2 ? packed : plain)->size())),
            .speed_unit = "ms",
            .error = static_cast<double>(differences.model.size() + differences.provenance.size()),
            .error_unit = "differences of the models",
            .reference = "the file that is not compressed",
            .must_is_least = false,
            .must_error = 0.5};
    set_time(row, timings[i], 1e3);
    context.add(row);
  }
}

void run(Context& context) {
  DiagnosticLog log;
  const auto small = compiler::compiled(sphere_scene({20, 30}, lambert_material(0.8)), {}, log);
  if (!small) {
    context.note("a sphere could not be compiled");
    return;
  }
  const int wrong = undetected(*small, context.quick() ? 50 : 2000);
  for (const std::uint32_t side : {60u, 460u, 4600u}) {
    if (context.quick() && side > 460) continue;
    run_size(context, side, wrong);
  }
  for (const std::uint32_t side : {60u, 460u, 1500u})
    if (!context.quick() || side <= 60) run_compressed(context, side);
}

const bool kAdded = add_case({"pan", "opening and checking compiled files", run});

}  // namespace

}  // namespace panwright::bench::case_pan
