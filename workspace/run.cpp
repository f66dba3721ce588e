#include "workspace/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "base/clock.h"
#include "base/file_uses.h"
#include "labels/frame_files.h"
#include "workspace/internal/forward.h"
#include "workspace/internal/instrument_run.h"
#include "workspace/internal/sky_words.h"
#include "workspace/lamp_text.h"
#include "workspace/sky_settings.h"
#include "world/evaluation.h"

namespace panwright::workspace {

std::string name_of(const Frame& frame) {
  return frame.outputs.empty() ? frame.label : frame.outputs[0];
}

namespace {

// Checks of the frames that need no drawing.
bool are_sound(const world::World& world, std::span<const Frame> frames, DiagnosticLog& log) {
  const std::size_t errors = log.errors();
  FileUses own;  // where the run's host watches none
  FileUses& files = log.files() ? *log.files() : own;
  if (world.empty() &&
      !std::ranges::all_of(frames, [](const Frame& f) { return shows_sky(f.settings); }))
    log.report(Code("E5030"), {}, "the world has no targets, expected at least 1, or a sky");
  for (const Frame& frame : frames) {
    DiagnosticLog apart = log.apart();
    for (const std::string& output : frame.outputs) {
      std::visit([&](const auto& kind) { check_output(kind, output, apart); }, frame.instrument);
      files.will_write(output, "the output", apart);
    }
    if (frame.labels && !frame.outputs.empty())
      for (const std::string_view extension : {labels::kLabelsExtension, labels::kMasksExtension})
        files.will_write(std::filesystem::path(frame.outputs.front())
                             .replace_filename(frame.labels->name + std::string(extension)),
                         "the labels", apart);
    for (const TargetPose& pose : frame.poses) (void)world.require(pose.target, apart);
    (void)check(frame.settings, apart);
    forward(apart, frame.label, {}, log);
  }
  return log.errors() == errors && have_parts(world, frames, log);
}

// What models gave the frame, and its sky.
void tell_models(const Frame& frame, const world::World& world, Written& what) {
  what.of_scene = frame.of_scene;
  what.scene_target = frame.scene_target;
  what.sky = sky_words(frame, world);
  for (const world::Lamp& lamp : frame.lamps.value_or(std::vector<world::Lamp>()))
    if (!lamp.name.empty()) (lamp.on ? what.lamps_on : what.lamps_off).push_back(lamp_path(lamp));
}

// A product that is being written, or kept.
struct Writing {
  Written what;
  Product product;
  InstrumentRun* run = nullptr;
  const Frame* frame = nullptr;
  double seconds = 0;
  double labels_seconds = 0;
  double sync = 0;
  bool ok = true;
  std::optional<labels::FrameLabels> labels;  // kept
  DiagnosticLog log;
};

// note: not cancelled, so that a frame whose image is written is whole
void write_labels(Writing& writing, const world::World& world, FrameLabeller& labeller,
                  std::size_t threads, bool keeps) {
  const auto* product = std::get_if<ImageProduct>(&writing.product);
  if (!writing.ok || !writing.frame->labels || product == nullptr) return;
  const auto start = std::chrono::steady_clock::now();
  auto labels =
      labeller.label(*writing.frame, world, product->image, writing.log, Job({threads, {}}));
  writing.ok = bool(labels);
  if (labels && keeps)
    writing.labels = *std::move(labels);
  else if (labels)
    writing.ok =
        labels::write_frame(std::filesystem::path(writing.frame->outputs.front()).parent_path(),
                            *labels, writing.log, &writing.sync);
  writing.labels_seconds = seconds_since(start);
}

void write_all(Writing& writing) {
  const auto start = std::chrono::steady_clock::now();
  std::visit(
      [&](auto& product) {
        for (const std::string& output : writing.what.outputs)
          writing.ok = writing.ok && write(product, output, writing.log, &writing.sync);
      },
      writing.product);
  writing.seconds = seconds_since(start);
}

class Run {
 public:
  Run(const world::World& world, std::span<const Frame> frames, const RunOptions& options,
      Drawers& drawers, DiagnosticLog& log, const Job& job)
      : scope_{world, options, log, job}, frames_(frames), drawers_(drawers), current_(world) {}

  // An image that does not fit into memory. False: another lack of it.
  bool report_memory() {
    constexpr std::uint64_t kSmall = std::uint64_t{1} << 24;  // pixels
    const auto* camera =
        current_frame_ ? std::get_if<CameraInstrument>(&current_frame_->instrument) : nullptr;
    if (camera == nullptr) return false;
    const auto [width, height] = std::pair(camera->camera.width, camera->camera.height);
    const std::uint64_t pixels = std::uint64_t{width} * height;
    if (pixels < kSmall) return false;
    const double bytes = stores_ground_truth(*current_frame_) ? 48 : 16;
    scope_.log.report_file(
        Code("E5003"), {},
        fmt::format("{}{}there is not enough memory for an image of {} by {} pixels, which takes "
                    "{:.3g} GB and as much again while it is drawn",
                    current_frame_->label, current_frame_->label.empty() ? "" : ": ", width, height,
                    1e-9 * static_cast<double>(pixels) * bytes),
        "a smaller --size; PNG and NPY take a third of EXR");
    return true;
  }

  Result<std::size_t> run() {
    if (!are_sound(scope_.world, frames_, scope_.log)) return failed;
    if (frames_.empty()) return std::size_t{0};
    if (!run_of(frames_[0]).prepare(frames_[0])) return failed;
    find_work();
    Phase phase(scope_.job, "rendering", frames_.size());
    try {
      // while one frame is drawn, the one before is copied and the one before that is written
      bool good = true;
      std::size_t begun = 0;
      while (good && begun < frames_.size() && begin(begun, phase)) {
        ++begun;
        scope_.job.poll();
      }
      // what was begun is written, even where a later frame fails
      while (good && !under_way_.empty()) {
        scope_.job.poll();
        good = end(phase);
      }
    } catch (const Cancelled&) {
      (void)retire();
      finish();
      throw;
    }
    // note: first, so that the last image is reported in any case
    const bool last = retire();
    finish();
    if (!last || done_ < frames_.size()) return failed;
    return done_;
  }

 private:
  // What frames take, estimated by the pixels of the image and, ten times as much each, those of
  // the boxes of its targets.
  void find_work() {
    constexpr double kTarget = 10;
    double sum = 0;
    work_.clear();
    world::Evaluation evaluation;
    evaluation.update(scope_.world);  // once: boxes change little as joints turn
    for (const Frame& frame : frames_) {
      const auto* instrument = std::get_if<CameraInstrument>(&frame.instrument);
      if (instrument == nullptr) {
        work_.push_back(sum += 1);
        continue;
      }
      const world::Camera& camera = instrument->camera;
      show(frame, scope_.world, current_);
      const double pixels = static_cast<double>(camera.width) * camera.height;
      double covered = 0;
      for (std::size_t i = 0; i < current_.size(); ++i) {
        const std::optional<AxisBox>& box = evaluation[i].bounds;
        if (!box) continue;
        const world::Pose& pose = current_[i].pose();
        const double radius = 0.5 * glm::length(box->high - box->low);
        const Vec3 centre = pose.translation + pose.rotation * (0.5 * (box->low + box->high));
        const bool flat = camera.projection == world::Projection::orthographic;
        const double distance = glm::length(centre - camera.position);
        const double side = 2 * radius * camera.focal.x / (flat ? 1 : std::max(distance, radius));
        covered += std::min(side * side, pixels);
      }
      sum += pixels + kTarget * std::min(covered, pixels);
      work_.push_back(sum);
    }
    for (double& work : work_) work /= sum;
  }

  // Of an instrument's kind.
  InstrumentRun& run_of(const Frame& frame) {
    std::unique_ptr<InstrumentRun>& run = runs_[frame.instrument.index()];
    if (run == nullptr)
      run = std::visit([&](const auto& kind) { return workspace::run_of(kind, scope_, drawers_); },
                       frame.instrument);
    return *run;
  }

  // Begins a frame. False: stop.
  bool begin(std::size_t index, Phase& phase) {
    scope_.job.poll();
    const Frame& frame = frames_[index];
    InstrumentRun& run = run_of(frame);
    // products come in the order of frames
    while (!under_way_.empty() &&
           (under_way_.back().run != &run || under_way_.size() >= run.room(frame)))
      if (!end(phase)) return false;
    current_frame_ = &frame;
    show(frame, scope_.world, current_);
    if (!run.begin(frame, current_)) return false;
    under_way_.push_back({index, &run});
    return true;
  }

  // Ends the oldest frame and begins to write it. False: stop.
  bool end(Phase& phase) {
    const auto [index, run] = under_way_.front();
    under_way_.pop_front();
    const Frame& frame = frames_[index];
    current_frame_ = &frame;
    const bool collected = run->collect();
    if (!retire() || !collected) return false;
    current_frame_ = &frame;
    Measurement measurement = run->take();
    phase.advance(1, work_[index]);
    writing_ = std::make_unique<Writing>();
    writing_->log = scope_.log.apart();
    writing_->run = run;
    writing_->frame = &frame;
    writing_->product = std::move(measurement.product);
    Written& what = writing_->what = std::move(measurement.what);
    what.frame = index;
    what.outputs = frame.outputs;
    for (const world::Instance& target : scope_.world.instances())
      what.targets.push_back(target.name());
    tell_models(frame, scope_.world, what);
    const bool keeps = bool(scope_.options.listener.kept);
    if (index + 1 == frames_.size() || scope_.job.threads() == 1 || (keeps && !frame.labels)) {
      if (!keeps) write_all(*writing_);
      write_labels(*writing_, scope_.world, drawers_.labels, scope_.job.threads(), keeps);
      return retire();
    }
    // one thread beside those that draw the next image
    pending_ = std::async(std::launch::async, [this, keeps, &writing = *writing_] {
      if (!keeps) run_on_threads(Job({1, {}}), [&] { write_all(writing); });
      write_labels(writing, scope_.world, drawers_.labels, scope_.job.threads(), keeps);
    });
    return true;
  }

  // Waits for the product that is being written. False: it could not be.
  bool retire() {
    if (writing_) current_frame_ = &frames_[writing_->what.frame];
    if (pending_.valid()) pending_.get();
    const std::unique_ptr<Writing> writing = std::move(writing_);
    if (writing == nullptr) return true;
    forward(writing->log, frames_[writing->what.frame].label, {}, scope_.log);
    const auto& seen = scope_.options.listener.seen;
    if (seen && writing->ok) seen(scope_.world, *writing->frame, writing->product);
    const auto& kept = scope_.options.listener.kept;
    if (kept && writing->ok) {
      ++done_;
      Kept all{std::move(writing->what), std::move(writing->product), std::move(writing->labels)};
      kept(all);
      writing->run->recycle(all.what, std::move(all.product));
      return true;
    }
    writing->run->recycle(writing->what, std::move(writing->product));
    if (!writing->ok) return false;
    ++done_;
    tell({"write " + writing->what.outputs[0], writing->seconds});
    if (writing->labels_seconds > 0) tell({"label", writing->labels_seconds});
    tell({"sync to disk", writing->sync});
    if (scope_.options.listener.written) scope_.options.listener.written(writing->what);
    return true;
  }

  void finish() {
    for (const auto& run : runs_)
      if (run != nullptr) run->finish();
  }

  void tell(const Step& step) const {
    if (scope_.options.listener.step) scope_.options.listener.step(step);
  }

  const RunScope scope_;
  const std::span<const Frame> frames_;
  Drawers& drawers_;
  world::World current_;
  std::array<std::unique_ptr<InstrumentRun>, std::variant_size_v<Instrument>> runs_;
  const Frame* current_frame_ = nullptr;  // that the work is on
  std::size_t done_ = 0;
  std::vector<double> work_;  // share that is over after each frame
  struct UnderWay {
    std::size_t index = 0;
    InstrumentRun* run = nullptr;
  };
  std::deque<UnderWay> under_way_;
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
      if (*drawer && (!whole || (*drawer)->in_flight() > 0 || log.contains(Code("E5001"))))
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
