// Data sets: time to plan frames, beside the error of their convex outlines as areas of a sphere.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include "bench/bench.h"
#include "workspace/dataset.h"

namespace panwright::bench::case_dataset {

namespace {

// Largest relative error of the pixels of a unit sphere on the axis: a disc of angular radius
// asin(1 / range).
double area_error(const std::vector<workspace::PlannedFrame>& frames, double focal) {
  double worst = 0;
  for (const auto& frame : frames) {
    const double exact = M_PI * focal * focal / (frame.range * frame.range - 1);
    worst = std::max(worst, std::fabs(frame.pixels / exact - 1));
  }
  return worst;
}

void run_dataset(Context& context) {
  const auto folder = context.scratch();
  std::ofstream(folder / "ball.pxn")
      << "<pangu_model ver=\"1\"><sphere radius=\"1m\"/></pangu_model>";
  const std::size_t count = context.quick() ? 500 : 10'000;
  std::ofstream(folder / "plan.toml")
      << "frames = " << count
      << "\nseed = 1\n[targets]\nball = \"ball.pxn\"\n[view]\nsize = [512, 512]\n"
         "intrinsics = [1000, 1000, 256, 256]\n[camera]\nrange = { log_uniform = [10, 100] }\n"
         "attitude = \"random\"\n[sun]\nphase = [0, 110]\nkeep_out = 30\n";
  DiagnosticLog log;
  const auto plan = workspace::read_dataset_plan(folder / "plan.toml", log);
  if (!plan) return context.note("the plan cannot be read");
  workspace::ViewSession session({}, preview::ContextKind::automatic);
  std::vector<workspace::PlannedFrame> frames;
  const auto timings =
      interleaved({{"plan",
                    [&] {
                      std::string view = plan->view;
                      auto made = workspace::plan_frames(*plan, folder, session, view, log);
                      if (made) frames = *std::move(made);
                    }}},
                  context.runs());
  if (frames.empty()) return context.note("no frame was planned");
  Row row{.case_name = "dataset",
          .setting = "frames=" + std::to_string(count),
          .speed_unit = "frames/s",
          .error = area_error(frames, 1000),
          .error_unit = "relative, of pixels",
          .reference = "disc of a sphere, closed form",
          .reference_error = 1e-15,
          .must = 5000,
          .must_error = 0.01};
  set_rate(row, timings[0], static_cast<double>(count));
  context.add(row);
}

const bool kAdded = add_case({"dataset", "planning of data sets", run_dataset});

}  // namespace

}  // namespace panwright::bench::case_dataset
