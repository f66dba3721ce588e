// RADARs: speed of a histogram beside the error of a cross-section.
#include <fmt/core.h>

#include <cmath>
#include <memory>

#include "base/math.h"
#include "bench/bench.h"
#include "geometry/tessellate/tessellate.h"
#include "instruments/radar.h"
#include "pan/model.h"
#include "pan/writer.h"

namespace panwright::bench::case_radar {

namespace {

using instruments::Radar;
using instruments::ScatterLaw;

world::World sphere_world(double radius, std::uint32_t rings) {
  DiagnosticLog log;
  const auto mesh = geometry::tessellated(
      geometry::Sphere{radius, geometry::SphereCounts{rings, 2 * rings}}, {}, {}, log);
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.meshes.push_back(pan::packed(*mesh, "sphere"));
  contents.materials.emplace_back();
  contents.instances.push_back({0, 0, 0, -1});
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "sphere.pan", log);
  world::World world;
  if (model && model->check(log))
    (void)world.add("sphere", std::make_shared<const pan::Model>(std::move(*model)), log);
  return world;
}

void run(Context& context) {
  for (const bool metal : {false, true}) {
    const double radius = 0.1;
    const auto world = sphere_world(radius, context.quick() ? 100 : 200);
    Radar radar;
    radar.frequency = instruments::kLightSpeed / 0.03;
    radar.bandwidth = 300e6;
    radar.range = Vec2(190, 210);
    radar.rays = context.quick() ? 128 : 512;
    radar.surfaces = {{"*", metal ? ScatterLaw::metal : ScatterLaw::lambert, metal ? 1.0 : 0.3}};
    // looks along +z from -z; the sphere's poles lie across
    const instruments::RadarMoment moment{world, {{-200, 0, 0}, Quat(0.5, 0.5, 0.5, 0.5)}};
    DiagnosticLog log;
    Result<instruments::RadarHistogram> found = failed;
    const Timing timing =
        timed([&] { found = instruments::measure(radar, moment, nullptr, {}, log); },
              context.quick() ? 1 : 5);
    if (!found) continue;
    const double disc = kPi * radius * radius;
    const double exact = metal ? disc : 8.0 / 3 * 0.3 * disc;
    Row row{
        .case_name = "radar",
        .setting = fmt::format("{} rays={}", metal ? "metal, 3 bounces" : "lambert", found->rays),
        .speed_unit = "Mray/s",
        .error = std::fabs(found->targets[0].cross_section / exact - 1),
        .error_unit = "relative",
        .reference = metal ? "cross-section of a sphere by geometric optics"
                           : "cross-section of a Lambert sphere",
        .must_error = 0.02};
    set_rate(row, timing, 1e-6 * static_cast<double>(found->rays));
    context.add(row);
  }
}

const bool kAdded = add_case({"radar", "histograms of RADARs", run});

}  // namespace

}  // namespace panwright::bench::case_radar
