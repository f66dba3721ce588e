#include "workspace/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <utility>

#include "base/file_uses.h"
#include "base/text.h"
#include "workspace/exposure.h"
#include "workspace/internal/stopwatch.h"

namespace panwright::workspace {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A PNG shows a white plate as white whatever the irradiance is measured in.
double stops_of_sun(const world::Sun& sun) {
  if (!sun.irradiance) return 0;
  const Vec3& e = *sun.irradiance;
  const double strongest = std::max({e.x, e.y, e.z});
  return strongest > 0 ? std::log2(strongest) : 0;
}

std::string words(const Vec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }
std::string words(const Quat& q) { return fmt::format("{} {} {} {}", q.w, q.x, q.y, q.z); }

using Metadata = decltype(preview::Image::metadata);

// Metadata of an image, for its header.
void describe(const world::World& world, const world::Camera& camera, const DrawOptions& options,
              Metadata& metadata) {
  const auto add = [&](std::string name, std::string value) {
    metadata.emplace_back(std::move(name), std::move(value));
  };
  if (world.size() == 1) {
    add("panwright.build_id", world[0].model()->build_id().hex());
  } else {
    std::string names;
    for (const world::Instance& target : world.instances()) {
      names += (names.empty() ? "" : "\n") + target.name();
      add("panwright.build_id." + target.name(), target.model()->build_id().hex());
      add("panwright.pose." + target.name(),
          words(target.pose().translation) + " " + words(target.pose().rotation));
    }
    add("panwright.targets", names);
  }
  add("panwright.camera", words(camera.position));
  add("panwright.quat", words(camera.world_from_camera));
  add("panwright.intrinsics", fmt::format("{},{},{},{}", camera.focal.x, camera.focal.y,
                                          camera.principal.x, camera.principal.y));
  add("panwright.sun", words(world.sun().direction));
  const bool traced = options.engine == Engine::reference;
  const unsigned own = traced ? options.reference.samples : options.gl.samples;
  const unsigned samples = options.samples > 0 ? options.samples : own;
  add("panwright.samples", samples > 0 ? fmt::format("{}", samples) : "auto");
  if (samples == 0) add("panwright.pixel_error", fmt::format("{}", options.gl.pixel_error));
  if (!traced) add("panwright.shadow_side", fmt::format("{}", options.gl.shadow_side));
}

// Checks of the views that need no drawing.
bool are_sound(const world::World& world, std::span<const View> views, DiagnosticLog& log) {
  const std::size_t errors = log.errors();
  FileUses own;  // where the run's host watches none
  FileUses& files = log.files() ? *log.files() : own;
  if (world.empty()) log.report(Code::E5030, {}, "the world has no targets, expected at least 1");
  for (const View& view : views) {
    if (!preview::image_format(view.output))
      log.report(Code::E0202, {},
                 fmt::format("unknown image format of {}, expected .png, .exr, .npy or .npz",
                             in_quotes(view.output)));
    for (const TargetPose& pose : view.poses) (void)world.require(pose.target, log);
    files.will_write(view.output, "the output", log);
  }
  return log.errors() == errors;
}

// A view that is being drawn.
struct Drawing {
  std::size_t view = 0;  // its index
  double ev = 0;
  double shown_ev = 0;  // as --ev has it
  double seconds = 0;  // so far
  Metadata metadata;
};

// An image that is being written.
struct Writing {
  Written what;
  preview::Image image;
  double seconds = 0;
  double sync = 0;
  bool ok = false;
  DiagnosticLog log;
};

void write(double ev, Writing& writing) {
  const auto start = Clock::now();
  writing.ok =
      preview::write_image(writing.what.output, writing.image, ev, writing.log, &writing.sync);
  writing.seconds = seconds_since(start);
}

class Run {
 public:
  Run(const world::World& world, std::span<const View> views, const RunOptions& options,
      DiagnosticLog& log, const Job& job)
      : world_(world), views_(views), options_(options), log_(log), job_(job), current_(world) {}

  Result<std::size_t> run() {
    if (!are_sound(world_, views_, log_)) return failed;
    if (!prepare()) return failed;
    if (options_.listener.ready) options_.listener.ready(drawer_->info());
    Phase phase(job_, "rendering", views_.size());
    try {
      // while one view is drawn, the one before is copied and the one before that is written
      bool good = true;
      std::size_t begun = 0;
      while (good && begun < views_.size() && begin(begun)) {
        ++begun;
        job_.poll();
        if (drawing_.size() == depth()) good = end(phase);
      }
      // what was begun is written, even where a later view fails
      while (good && drawer_->in_flight() > 0) {
        job_.poll();
        good = end(phase);
      }
    } catch (const Cancelled&) {
      (void)retire();
      throw;
    }
    // note: first, so that the last image is reported in any case
    const bool last = retire();
    if (!last || done_ < views_.size()) return failed;
    return done_;
  }

 private:
  bool prepare() {
    OpenReport report;
    const bool gl = options_.draw.engine == Engine::gl;
    {
      const Stopwatch watch(gl ? &report : nullptr, "open an OpenGL context");
      auto drawer = Drawer::create(options_.draw, log_);
      if (!drawer) return false;
      drawer_.emplace(*std::move(drawer));
    }
    job_.poll();
    std::string models;
    for (const world::Instance& target : world_.instances())
      models += (models.empty() ? "" : ", ") + target.model()->name();
    {
      const Stopwatch watch(&report, (gl ? "upload " : "prepare ") + models);
      if (!drawer_->prepare(world_, log_, job_)) return false;
    }
    for (const Step& step : report.steps) tell(step);
    return true;
  }

  // Maximum number of views in flight.
  std::size_t depth() const {
    return options_.draw.engine == Engine::gl ? Drawer::kMostInFlight : 1;
  }

  // Begins to draw a view. False: stop.
  bool begin(std::size_t index) {
    job_.poll();
    const View& view = views_[index];
    pose(view);
    const bool ground_truth = preview::stores_ground_truth(*preview::image_format(view.output));
    const auto start = Clock::now();
    if (!drawer_->submit(current_, view.camera, ground_truth, log_, job_)) return false;
    Drawing drawing;
    drawing.view = index;
    drawing.ev = view.ev - stops_of_sun(current_.sun());
    describe(current_, view.camera, options_.draw, drawing.metadata);
    drawing.seconds = seconds_since(start);
    drawing_.push_back(std::move(drawing));
    return true;
  }

  // Ends the oldest view and begins to write it. False: stop.
  bool end(Phase& phase) {
    Drawing drawing = std::move(drawing_.front());
    drawing_.pop_front();
    const View& view = views_[drawing.view];
    const auto start = Clock::now();
    auto drawn = drawer_->collect(log_, job_);
    if (drawn) tell({"render " + view.output, drawing.seconds + seconds_since(start)});
    if (!retire() || !drawn) return false;
    if (drawn->sampling) warn_of_error(view.output, *drawn->sampling);
    phase.advance();
    preview::Image& image = drawn->image;
    drawing.shown_ev = view.auto_ev ? auto_exposure(image, -drawing.ev) : view.ev;
    if (view.auto_ev) drawing.ev += drawing.shown_ev;
    image.metadata = drawing.metadata;
    writing_ = std::make_unique<Writing>();
    writing_->log = log_.apart();
    writing_->what = {drawing.view, view.output,     image.width,    image.height,
                      image.unit,   drawn->measured, drawn->sampling};
    writing_->image = std::move(image);
    if (drawing.view + 1 == views_.size() || job_.threads() == 1) {
      write(drawing.ev, *writing_);
      return retire();
    }
    // one thread beside those that draw the next image
    pending_ = std::async(std::launch::async, [ev = drawing.ev, &writing = *writing_] {
      run_on_threads(Job({1, {}}), [&] { write(ev, writing); });
    });
    return true;
  }

  // Sets the state of one view. Setters that change nothing keep caches valid.
  void pose(const View& view) {
    std::vector<world::Pose> poses;
    for (const world::Instance& target : world_.instances()) poses.push_back(target.pose());
    for (const TargetPose& each : view.poses) poses[*world_.find(each.target)] = each.pose;
    for (std::size_t i = 0; i < poses.size(); ++i) current_.set_pose(i, poses[i]);
    current_.set_sun(view.sun.value_or(world_.sun()));
  }

  // Waits for the image that is being written. False: it could not be.
  bool retire() {
    if (pending_.valid()) pending_.get();
    const std::unique_ptr<Writing> writing = std::move(writing_);
    if (writing == nullptr) return true;
    for (const Diagnostic& each : writing->log.entries())
      log_.report_file(each.code,
                       each.where.file == kNoFile
                           ? std::string()
                           : writing->log.sources().file(each.where.file).name,
                       each.message, each.hint);
    drawer_->recycle(std::move(writing->image));
    if (!writing->ok) return false;
    ++done_;
    tell({"write " + writing->what.output, writing->seconds});
    tell({"sync to disk", writing->sync});
    if (options_.listener.written) options_.listener.written(writing->what);
    return true;
  }

  void warn_of_error(const std::string& output, const preview::SamplingReport& report) const {
    const double asked = options_.draw.gl.pixel_error;
    const double reached = std::max(report.rmse, report.flux);
    if (options_.draw.gl.samples > 0 || reached <= asked) return;
    log_.report_file(Code::W5008, output,
                     fmt::format("the estimated error is {:.2g} %, more than the {:.2g} % that "
                                 "--pixel-error asks for",
                                 100 * reached, 100 * asked));
  }

  void tell(const Step& step) const {
    if (options_.listener.step) options_.listener.step(step);
  }

  const world::World& world_;
  const std::span<const View> views_;
  const RunOptions& options_;
  DiagnosticLog& log_;
  const Job& job_;
  world::World current_;
  std::optional<Drawer> drawer_;
  std::size_t done_ = 0;
  std::deque<Drawing> drawing_;  // those begun and not ended
  std::unique_ptr<Writing> writing_;
  std::future<void> pending_;  // after writing_: it is waited for first
};

}  // namespace

Result<std::size_t> run_views(const world::World& world, std::span<const View> views,
                              const RunOptions& options, DiagnosticLog& log, const Job& job) {
  return run_job(job, log, [&] { return Run(world, views, options, log, job).run(); });
}

}  // namespace panwright::workspace
