#include "workspace/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <future>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "base/clock.h"
#include "base/file_uses.h"
#include "base/text.h"
#include "workspace/exposure.h"
#include "workspace/internal/forward.h"
#include "workspace/internal/stopwatch.h"
#include "world/inside.h"

namespace panwright::workspace {

namespace {

using Clock = std::chrono::steady_clock;

// A PNG shows a white plate as white whatever the irradiance is measured in; where the Sun is off,
// white emission.
double stops_of_sun(const world::World& world) {
  const std::optional<Vec3>& irradiance = world.sun().irradiance;
  if (!irradiance) return 0;
  const double sun = max_component(*irradiance);
  const double strongest = sun > 0 ? sun : max_component(world.white());
  return strongest > 0 ? std::log2(strongest) : 0;
}

std::string words(const Vec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }
std::string words(const Quat& q) { return fmt::format("{} {} {} {}", q.w, q.x, q.y, q.z); }

using Metadata = decltype(image::Image::metadata);

// Metadata of an image, for its header.
void describe(const world::World& world, const world::Camera& camera, const DrawOptions& options,
              std::string record, Metadata& metadata) {
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
  if (!traced)
    add("panwright.shadow_side",
        options.gl.shadow_side ? fmt::format("{}", *options.gl.shadow_side) : "auto");
  if (!traced && options.gl.shadows != preview::Shadows::automatic)
    add("panwright.shadows", options.gl.shadows == preview::Shadows::hard ? "hard" : "soft");
  add(image::kRecordName, std::move(record));
}

bool stores_ground_truth(const Frame& frame, const DrawOptions& draw) {
  return std::any_of(frame.outputs.begin(), frame.outputs.end(), [&](const std::string& output) {
    return image::stores_ground_truth(*image::image_format(output), draw.files);
  });
}

// Checks of the frames that need no drawing.
bool are_sound(const world::World& world, std::span<const Frame> frames, DiagnosticLog& log) {
  const std::size_t errors = log.errors();
  FileUses own;  // where the run's host watches none
  FileUses& files = log.files() ? *log.files() : own;
  if (world.empty()) log.report(Code::E5030, {}, "the world has no targets, expected at least 1");
  for (const Frame& frame : frames) {
    DiagnosticLog apart = log.apart();
    for (const std::string& output : frame.outputs) {
      if (!image::image_format(output))
        apart.report(Code::E0202, {},
                     fmt::format("unknown image format of {}, expected .png, .exr, .npy or .npz",
                                 in_quotes(output)));
      files.will_write(output, "the output", apart);
    }
    for (const TargetPose& pose : frame.poses) (void)world.require(pose.target, apart);
    (void)check(frame.settings, apart);
    forward(apart, frame.label, {}, log);
  }
  return log.errors() == errors;
}

// A view that is being drawn.
struct Drawing {
  std::size_t frame = 0;  // its index
  Drawer* drawer = nullptr;
  double ev = 0;
  double shown_ev = 0;  // as --ev has it
  bool photo = false;
  double seconds = 0;  // so far
  Metadata metadata;
};

// An image that is being written.
struct Writing {
  Written what;
  image::Image image;
  image::FileOptions files;
  std::string record;  // of files without ids
  Drawer* drawer = nullptr;
  double seconds = 0;
  double sync = 0;
  bool ok = false;
  DiagnosticLog log;
};

void write(const image::PngExposure& exposure, Writing& writing) {
  const auto start = Clock::now();
  const auto write_one = [&](const std::string& output) {
    const bool has_ids = image::stores_ground_truth(*image::image_format(output), writing.files);
    writing.image.metadata.back().second = has_ids ? writing.what.record : writing.record;
    return image::write_image(output, writing.image, exposure, writing.log, &writing.sync,
                              writing.files);
  };
  writing.ok = true;
  for (const std::string& output : writing.what.outputs)
    writing.ok = writing.ok && write_one(output);
  writing.seconds = seconds_since(start);
}

}  // namespace

// At most one drawer of each engine.
struct Runner::Drawers {
  std::optional<Drawer> gl;
  std::optional<Drawer> reference;
  std::optional<Drawer>& of(const DrawOptions& options) {
    return options.engine == Engine::gl ? gl : reference;
  }
};

namespace {

class Run {
 public:
  Run(const world::World& world, std::span<const Frame> frames, const RunOptions& options,
      Runner::Drawers& drawers, DiagnosticLog& log, const Job& job)
      : world_(world),
        frames_(frames),
        options_(options),
        drawers_(drawers),
        log_(log),
        job_(job),
        current_(world) {}

  // An image that does not fit into memory. False: another lack of it.
  bool report_memory() {
    constexpr std::uint64_t kSmall = std::uint64_t{1} << 24;  // pixels
    const std::uint64_t pixels = current_frame_ ? std::uint64_t{current_frame_->camera().width} *
                                                      current_frame_->camera().height
                                                : 0;
    if (pixels < kSmall) return false;
    log_.report_file(
        Code::E5003, {},
        fmt::format(
            "{}{}there is not enough memory for an image of {} by {} pixels, which takes "
            "{:.3g} GB and as much again while it is drawn",
            current_frame_->label, current_frame_->label.empty() ? "" : ": ",
            current_frame_->camera().width, current_frame_->camera().height,
            1e-9 * static_cast<double>(
                       pixels * (stores_ground_truth(
                                     *current_frame_,
                                     draws_[static_cast<std::size_t>(current_frame_ - &frames_[0])])
                                     ? 48
                                     : 16))),
        "a smaller --size; PNG and NPY take a third of EXR");
    return true;
  }

  Result<std::size_t> run() {
    if (!are_sound(world_, frames_, log_)) return failed;
    if (frames_.empty()) return std::size_t{0};
    for (const Frame& frame : frames_)
      draws_.push_back(draw_options(frame.settings, options_.context));
    if (!prepare(draws_[0])) return failed;
    find_work();
    Phase phase(job_, "rendering", frames_.size());
    try {
      // while one view is drawn, the one before is copied and the one before that is written
      bool good = true;
      std::size_t begun = 0;
      while (good && begun < frames_.size() && begin(begun, phase)) {
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
      warn_of_places();
      warn_of_imposters();
      throw;
    }
    // note: first, so that the last image is reported in any case
    const bool last = retire();
    warn_of_places();
    warn_of_imposters();
    if (!last || done_ < frames_.size()) return failed;
    return done_;
  }

 private:
  // What views take, estimated by the pixels of the image and, ten times as much each, those of the
  // boxes of its targets.
  void find_work() {
    constexpr double kTarget = 10;
    double sum = 0;
    work_.clear();
    evaluation_.update(world_);  // once: boxes change little as joints turn
    for (const Frame& frame : frames_) {
      show(frame, world_, current_);
      const double pixels = static_cast<double>(frame.camera().width) * frame.camera().height;
      double covered = 0;
      for (std::size_t i = 0; i < current_.size(); ++i) {
        const std::optional<AxisBox>& box = evaluation_[i].bounds;
        if (!box) continue;
        const world::Pose& pose = current_[i].pose();
        const double radius = 0.5 * glm::length(box->high - box->low);
        const Vec3 centre = pose.translation + pose.rotation * (0.5 * (box->low + box->high));
        const bool flat = frame.camera().projection == world::Projection::orthographic;
        const double distance = glm::length(centre - frame.camera().position);
        const double side =
            2 * radius * frame.camera().focal.x / (flat ? 1 : std::max(distance, radius));
        covered += std::min(side * side, pixels);
      }
      sum += pixels + kTarget * std::min(covered, pixels);
      work_.push_back(sum);
    }
    for (double& work : work_) work /= sum;
  }

  // Makes the drawer of an engine the one in use.
  bool prepare(const DrawOptions& draw) {
    OpenReport report;
    const bool gl = draw.engine == Engine::gl;
    std::optional<Drawer>& drawer = drawers_.of(draw);
    const bool fresh = !drawer;
    if (fresh) {
      const Stopwatch watch(gl ? &report : nullptr, "open an OpenGL context");
      auto created = Drawer::create(draw, log_);
      if (!created) return false;
      drawer.emplace(*std::move(created));
    }
    drawer_ = &*drawer;
    job_.poll();
    std::string models;
    for (const world::Instance& target : world_.instances())
      models += (models.empty() ? "" : ", ") + target.model()->name();
    {
      const Stopwatch watch(&report, (gl ? "upload " : "prepare ") + models);
      if (!drawer->prepare(world_, log_, job_)) return false;
    }
    for (const Step& step : report.steps) tell(step);
    if (fresh && options_.listener.ready) options_.listener.ready(drawer->info());
    return true;
  }

  // Maximum number of views in flight.
  std::size_t depth() const {
    return drawer_->info().engine == Engine::gl ? Drawer::kMostInFlight : 1;
  }

  // Begins to draw a view. False: stop.
  bool begin(std::size_t index, Phase& phase) {
    job_.poll();
    const Frame& frame = frames_[index];
    current_frame_ = &frame;
    const DrawOptions& draw = draws_[index];
    if (auto& wanted = drawers_.of(draw); !wanted || &*wanted != drawer_) {
      // images of two engines end in their order, too
      while (!drawing_.empty())
        if (!end(phase)) return false;
      if (!prepare(draw)) return false;
    }
    drawer_->set_options(draw);
    show(frame, world_, current_);
    const bool ground_truth = stores_ground_truth(frame, draw);
    const auto start = Clock::now();
    DiagnosticLog apart = log_.apart();
    warn_of_inside(frame);
    const bool good = drawer_->submit(current_, frame.camera(), ground_truth, apart, job_);
    tell(apart, frame.label);
    if (!good) return false;
    Drawing drawing;
    drawing.frame = index;
    drawing.drawer = drawer_;
    drawing.ev = frame.settings.ev->number.value_or(0) - stops_of_sun(current_);
    drawing.photo = draw.photo;
    describe(current_, frame.camera(), draw,
             record_text(current_, frame, options_.source, options_.context), drawing.metadata);
    drawing.seconds = seconds_since(start);
    drawing_.push_back(std::move(drawing));
    return true;
  }

  // Ends the oldest view and begins to write it. False: stop.
  bool end(Phase& phase) {
    Drawing drawing = std::move(drawing_.front());
    drawing_.pop_front();
    const Frame& frame = frames_[drawing.frame];
    current_frame_ = &frame;
    const auto start = Clock::now();
    DiagnosticLog apart = log_.apart();
    auto drawn = drawing.drawer->collect(apart, job_);
    tell(apart, frame.label);
    const double seconds = drawing.seconds + seconds_since(start);
    if (drawn) tell({"render " + frame.outputs[0], seconds});
    if (!retire() || !drawn) return false;
    if (drawn->sampling) {
      warn_of_error(frame, draws_[drawing.frame], *drawn->sampling);
      note_imposters(frame, draws_[drawing.frame], *drawn->sampling);
    }
    phase.advance(1, work_[drawing.frame]);
    image::Image& image = drawn->image;
    const std::optional<double>& stops = frame.settings.ev->number;
    drawing.shown_ev = stops ? *stops : auto_exposure(image, -drawing.ev);
    if (!stops) drawing.ev += drawing.shown_ev;
    image.metadata = drawing.metadata;
    std::string record = image.metadata.back().second;
    add_names(world_, image, record);
    const DrawOptions& draw = draws_[drawing.frame];
    writing_ = std::make_unique<Writing>();
    writing_->files = draw.files;
    writing_->record = image.metadata.back().second;
    writing_->log = log_.apart();
    Written& what = writing_->what;
    what.frame = drawing.frame;
    what.outputs = frame.outputs;
    what.width = image.width;
    what.height = image.height;
    what.unit = image.unit;
    what.engine = draw.engine;
    what.samples = draw.samples;
    what.ev = drawing.shown_ev;
    what.orthographic = frame.camera().projection == world::Projection::orthographic;
    what.seconds = seconds;
    for (const world::Instance& target : world_.instances()) what.targets.push_back(target.name());
    what.record = std::move(record);
    what.measured = drawn->measured;
    what.sampling = drawn->sampling;
    writing_->image = std::move(image);
    writing_->drawer = drawing.drawer;
    if (drawing.frame + 1 == frames_.size() || job_.threads() == 1) {
      write({drawing.ev, drawing.photo}, *writing_);
      return retire();
    }
    // one thread beside those that draw the next image
    pending_ = std::async(
        std::launch::async,
        [exposure = image::PngExposure(drawing.ev, drawing.photo), &writing = *writing_] {
          run_on_threads(Job({1, {}}), [&] { write(exposure, writing); });
        });
    return true;
  }

  // Waits for the image that is being written. False: it could not be.
  bool retire() {
    if (writing_) current_frame_ = &frames_[writing_->what.frame];
    if (pending_.valid()) pending_.get();
    const std::unique_ptr<Writing> writing = std::move(writing_);
    if (writing == nullptr) return true;
    forward(writing->log, frames_[writing->what.frame].label, {}, log_);
    writing->drawer->recycle(std::move(writing->image));
    if (!writing->ok) return false;
    ++done_;
    tell({"write " + writing->what.outputs[0], writing->seconds});
    tell({"sync to disk", writing->sync});
    if (options_.listener.written) options_.listener.written(writing->what);
    return true;
  }

  // Surfaces of closed parts are drawn from outside only.
  void warn_of_inside(const Frame& frame) {
    if (frame.camera().projection != world::Projection::perspective) return;
    evaluation_.update(current_);
    const auto part = world::closed_part_around(current_, evaluation_, frame.camera().position);
    if (!part) return;
    const world::Instance& target = current_[part->target];
    const std::string name = target.name() + "/" + target.model()->node_path(part->node);
    misplaced_[{Code::W5016, fmt::format("the camera is inside {}, whose surface is visible from "
                                         "outside only",
                                         in_quotes(name))}]
        .push_back(frame.label);
  }

  // Diagnostics of a view; those of the camera's place are reported of all such views at the end.
  void tell(const DiagnosticLog& said, const std::string& label) {
    forward(said, label, {}, log_, Code::W5006);
    for (const Diagnostic& each : said.entries())
      if (each.code == Code::W5006) misplaced_[{each.code, each.message}].push_back(label);
  }

  // One warning for all views in which nothing is seen or the camera is inside, for each reason.
  void warn_of_places() {
    constexpr std::size_t kMostNamed = 8;
    for (auto& [problem, labels] : misplaced_) {
      const auto& [code, reason] = problem;
      const std::size_t count = labels.size();
      if (count == 1) {
        log_.report_file(code, {}, labels[0].empty() ? reason : labels[0] + ": " + reason);
        continue;
      }
      labels.resize(std::min(count, kMostNamed));
      log_.report_file(code, {},
                       fmt::format("{} views: {} ({}{})", count, reason, fmt::join(labels, ", "),
                                   count > kMostNamed ? ", …" : ""));
    }
    misplaced_.clear();
  }

  // Imposters whose flux is far from what was asked: dark but for a few glints, mostly.
  void note_imposters(const Frame& frame, const DrawOptions& draw,
                      const preview::SamplingReport& report) {
    constexpr double kFar = 0.01, kTimes = 4;
    double worst = 0;
    for (const preview::ImposterReport& one : report.imposters)
      worst = std::max(worst, one.flux_error);
    const double asked = draw.gl.flux_error;
    if (worst <= std::max(kFar, kTimes * asked)) return;
    ++uncertain_.views;
    if (worst <= uncertain_.flux_error) return;
    uncertain_ = {uncertain_.views, worst, asked, frame.label, frame.outputs[0]};
  }

  // One warning for all views.
  void warn_of_imposters() {
    if (uncertain_.views > 0)
      log_.report_file(
          Code::W5008, uncertain_.output,
          fmt::format(
              "{}{}the estimated flux error of an imposter is {:.2g} %, expected at most {:.2g} % "
              "(--flux-error)",
              uncertain_.views > 1 ? fmt::format("{} views, the worst ", uncertain_.views) : "",
              uncertain_.label.empty() ? "" : uncertain_.label + ": ", 100 * uncertain_.flux_error,
              100 * uncertain_.asked),
          "the lit share is small or in narrow glints; the error is relative to it");
    uncertain_ = {};
  }

  void warn_of_error(const Frame& frame, const DrawOptions& draw,
                     const preview::SamplingReport& report) const {
    const double asked = draw.gl.pixel_error;
    const double reached = std::max(report.rmse, report.flux);
    // the line of the image states what is less
    constexpr double kLimited = 0.1;
    const double silent = report.limited ? std::max(asked, kLimited) : asked;
    if (draw.samples > 0 || draw.gl.samples > 0 || reached <= silent) return;
    log_.report_file(
        Code::W5008, frame.outputs[0],
        fmt::format("{}the estimated error is {:.2g} %, expected at most {:.2g} % (--pixel-error)",
                    frame.label.empty() ? "" : frame.label + ": ", 100 * reached, 100 * asked),
        report.limited ? "--quality standard limits the time of an image; --pixel-error does not"
                       : "");
  }

  void tell(const Step& step) const {
    if (options_.listener.step) options_.listener.step(step);
  }

  const world::World& world_;
  const std::span<const Frame> frames_;
  std::vector<DrawOptions> draws_;  // of frames
  const RunOptions& options_;
  Runner::Drawers& drawers_;
  DiagnosticLog& log_;
  const Job& job_;
  world::World current_;
  Drawer* drawer_ = nullptr;              // in use
  const Frame* current_frame_ = nullptr;  // that the work is on
  std::size_t done_ = 0;
  // labels of views, by W5006's and W5016's reasons
  std::map<std::pair<Code, std::string>, std::vector<std::string>> misplaced_;
  world::Evaluation evaluation_;
  std::vector<double> work_;  // share that is over after each view
  struct Uncertain {
    std::size_t views = 0;
    double flux_error = 0, asked = 0;  // of the worst
    std::string label, output;
  } uncertain_;
  std::deque<Drawing> drawing_;  // those begun and not ended
  std::unique_ptr<Writing> writing_;
  std::future<void> pending_;  // after writing_: it is waited for first
};

}  // namespace

Result<std::size_t> run_frames(const world::World& world, std::span<const Frame> frames,
                               const RunOptions& options, DiagnosticLog& log, const Job& job) {
  return Runner().run(world, frames, options, log, job);
}

Runner::Runner() : drawers_(std::make_unique<Drawers>()) {}
Runner::~Runner() = default;

Result<std::size_t> Runner::run(const world::World& world, std::span<const Frame> frames,
                                const RunOptions& options, DiagnosticLog& log, const Job& job) {
  bool whole = true;
  const auto drop_drawers = [&] {
    for (std::optional<Drawer>* drawer : {&drawers_->gl, &drawers_->reference})
      if (*drawer && (!whole || (*drawer)->in_flight() > 0 || log.contains(Code::E5001)))
        drawer->reset();
  };
  try {
    auto done = run_job(job, log, [&]() -> Result<std::size_t> {
      Run run(world, frames, options, *drawers_, log, job);
      try {
        return run.run();
      } catch (const std::bad_alloc&) {
        whole = false;
        if (!run.report_memory()) throw;
        return failed;
      }
    });
    if (!done) drop_drawers();
    return done;
  } catch (...) {
    whole = false;
    drop_drawers();  // what they hold may be half made
    throw;
  }
}

}  // namespace panwright::workspace
