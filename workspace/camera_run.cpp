// Cameras: images drawn by either engine, and their files.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/clock.h"
#include "base/text.h"
#include "sensor/camera_file.h"
#include "workspace/detecting.h"
#include "workspace/exposure.h"
#include "workspace/internal/exposure_sum.h"
#include "workspace/internal/forward.h"
#include "workspace/internal/instrument_run.h"
#include "workspace/internal/stopwatch.h"
#include "workspace/targets.h"
#include "world/inside.h"

namespace panwright::workspace {

namespace {

using CameraClock = std::chrono::steady_clock;

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
  if (camera.distortion != nullptr)
    add("panwright.distortion", sensor::distortion_text(camera.distortion->distortion()));
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

// An image that is being drawn.
struct Drawing {
  const Frame* frame = nullptr;
  DrawOptions draw;
  Drawer* drawer = nullptr;
  double ev = 0;       // of a PNG, without that of the view
  double seconds = 0;  // so far
  Metadata metadata;
  std::optional<Drawn> exposed;  // the whole image, of several moments
};

// A further number for each moment, from the seed of the image.
std::uint64_t seed_of(std::uint64_t seed, std::size_t moment) {
  if (moment == 0) return seed;
  // splitmix64
  std::uint64_t z = seed + moment * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

// Options of one of several moments: their samples add up to those of an image.
DrawOptions options_of_moment(DrawOptions draw, const Frame& frame, std::size_t moment) {
  preview::ReferenceOptions& reference = draw.reference;
  reference.seed = seed_of(reference.seed, moment);
  if (draw.engine != Engine::reference) return draw;
  constexpr std::uint32_t kLeast = 8;
  const std::uint32_t whole = draw.samples > 0 ? draw.samples * draw.samples : reference.samples;
  // moments that a row is the mean of
  std::uint32_t shared = 0;
  for (std::size_t k = 0; k < frame.moments.size(); ++k)
    if (frame.shutter->share(k, 0) > 0) ++shared;
  draw.samples = 0;
  reference.samples = std::max((whole + shared - 1) / std::max(shared, 1u), kLeast);
  return draw;
}

class CameraRun : public InstrumentRun {
 public:
  CameraRun(const RunScope& scope, Drawers& drawers) : scope_(scope), drawers_(drawers) {}

  bool prepare(const Frame& frame) override {
    return prepare(draw_options(frame.settings, scope_.options.context));
  }

  // With OpenGL one image is copied while the next is drawn. Images of two engines end in their
  // order.
  std::size_t room(const Frame& frame) override {
    if (drawing_.empty() || !frame.moments.empty()) return 1;
    const bool gl = drawer_->info().engine == Engine::gl;
    if ((*frame.settings.engine == Engine::gl) != gl) return 0;
    return gl ? Drawer::kMostInFlight : 1;
  }

  bool begin(const Frame& frame, const world::World& shown) override {
    Drawing drawing;
    drawing.frame = &frame;
    drawing.draw = draw_options(frame.settings, scope_.options.context);
    drawing.draw.cache = scope_.options.source.open.cache;
    const DrawOptions& draw = drawing.draw;
    if (auto& wanted = drawers_.of(draw); !wanted || &*wanted != drawer_)
      if (!prepare(draw)) return false;
    const world::Camera camera = detecting_.drawn_camera(frame, drawing.draw);
    drawer_->set_options(draw);
    const auto start = CameraClock::now();
    DiagnosticLog apart = scope_.log.apart();
    warn_of_inside(frame, shown);
    warn_of_lens(frame);
    const bool good =
        frame.moments.empty()
            ? drawer_->submit(shown, camera, stores_ground_truth(frame), apart, scope_.job)
            : expose(frame, draw, drawing.exposed, apart);
    tell(apart, frame.label);
    if (!good) return false;
    drawing.drawer = drawer_;
    drawing.ev = -stops_of_sun(shown);
    describe(shown, frame.camera(), draw,
             record_text(shown, frame, scope_.options.source, scope_.options.context),
             drawing.metadata);
    drawing.seconds = seconds_since(start);
    drawing_.push_back(std::move(drawing));
    return true;
  }

  bool collect() override {
    Drawing& drawing = drawing_.front();
    const auto start = CameraClock::now();
    DiagnosticLog apart = scope_.log.apart();
    // a lost context has dropped what was under way
    auto drawn = drawing.exposed                   ? Result<Drawn>(*std::move(drawing.exposed))
                 : drawing.drawer->in_flight() > 0 ? drawing.drawer->collect(apart, scope_.job)
                                                   : Result<Drawn>(failed);
    tell(apart, drawing.frame->label);
    drawing.seconds += seconds_since(start);
    if (drawn) {
      tell({"render " + name_of(*drawing.frame), drawing.seconds});
      drawn_ = *std::move(drawn);
    } else {
      drawing_.pop_front();
    }
    return bool(drawn);
  }

  Measurement take() override {
    Drawing drawing = std::move(drawing_.front());
    drawing_.pop_front();
    Drawn drawn = std::exchange(drawn_, Drawn{});
    const Frame& frame = *drawing.frame;
    if (drawn.sampling) {
      warn_of_error(frame, drawing.draw, *drawn.sampling);
      note_imposters(frame, *drawn.sampling);
    }
    image::Image& image = drawn.image;
    Detected detected;
    if (frame.imager != nullptr) detected = develop(frame, drawing, image);
    const double stops = frame.settings.ev->number.value_or(auto_stops(frame, image, -drawing.ev));
    Measurement out;
    Written& what = out.what;
    what.width = image.width;
    what.height = image.height;
    what.unit = image.unit;
    what.engine = drawing.draw.engine;
    what.samples = drawing.draw.samples;
    what.ev = stops;
    what.orthographic = frame.camera().projection == world::Projection::orthographic;
    what.seconds = drawing.seconds;
    what.moments = std::max<std::size_t>(frame.moments.size(), 1);
    what.measured = drawn.measured;
    what.exposure_s = detected.exposure_s;
    what.dn_bits = detected.bits;
    what.saturated = detected.saturated;
    what.sampling = drawn.sampling;
    what.between = drawn.between;
    what.ground_light = drawn.ground_light;
    what.ground_rays = drawn.ground_rays;
    what.record = drawing.metadata.back().second;
    add_names(scope_.world, image, what.record);
    auto& product = std::get<ImageProduct>(out.product);
    product.exposure = {stops + drawing.ev, drawing.draw.photo};
    product.files = drawing.draw.files;
    product.record = drawing.metadata.back().second;
    product.named_record = what.record;
    product.image = std::move(image);
    product.image.metadata = std::move(drawing.metadata);
    return out;
  }

  void recycle(const Written& what, Product product) override {
    auto& drawer = what.engine == Engine::gl ? drawers_.gl : drawers_.reference;
    if (!drawer) return;
    image::Image& image = std::get<ImageProduct>(product).image;
    // what the next one may not have
    image.dn.clear(), image.electrons.clear(), image.stages.clear(), image.filters.clear();
    image.dn_bits = 0;
    drawer->recycle(std::move(image));
  }

  void finish() override {
    warn_of_places();
    warn_of_imposters();
  }

 private:
  Detected develop(const Frame& frame, Drawing& drawing, image::Image& image) {
    const auto start = CameraClock::now();
    DiagnosticLog apart = scope_.log.apart();
    const bool stages = frame.settings.layers && drawing.draw.files.has(image::FileLayer::stages);
    const Detected out = detecting_.develop(frame, stages, image, apart);
    tell(apart, frame.label);
    tell({"detector", seconds_since(start)});
    drawing.metadata.insert(drawing.metadata.end() - 1,
                            {"panwright.exposure_s", fmt::format("{}", out.exposure_s)});
    return out;
  }

  static double auto_stops(const Frame& frame, const image::Image& image, double stops_of_sun) {
    return frame.settings.ev->number ? 0 : auto_exposure(image, stops_of_sun);
  }

  // Draws the mean of a frame's moments. What several say is said once.
  bool expose(const Frame& frame, const DrawOptions& draw, std::optional<Drawn>& out,
              DiagnosticLog& log) {
    const world::Camera& camera = frame.camera();
    const bool truth = stores_ground_truth(frame);
    const double bytes =
        ExposureSum::bytes(camera) + 1.0 * camera.width * camera.height * (truth ? 48 : 16);
    if (bytes > static_cast<double>(draw.gl.max_bytes)) {
      log.report_file(Code("E5003"), {},
                      fmt::format("the exposure of an image of {} by {} pixels takes {:.4g} GB of "
                                  "memory; the limit is {:.4g} GB",
                                  camera.width, camera.height, 1e-9 * bytes,
                                  1e-9 * static_cast<double>(draw.gl.max_bytes)),
                      "--max-image-memory allows more");
      return false;
    }
    DiagnosticLog apart = log.apart();
    ExposureSum sum(frame, draw.gl.psf_sigma);
    world::World shown = scope_.world;
    std::size_t added = 0;
    const auto collect = [&] {
      auto drawn = drawer_->collect(apart, scope_.job);
      if (!drawn) return false;
      sum.add(added++, *drawn);
      drawer_->recycle(std::move(drawn->image));
      return true;
    };
    bool good = true;
    for (std::size_t k = 0; good && k < frame.moments.size(); ++k) {
      scope_.job.poll();
      show(frame.moments[k], scope_.world, shown);
      drawer_->set_options(options_of_moment(draw, frame, k));
      good = drawer_->submit(shown, sum.camera(k), truth, apart, scope_.job) &&
             (drawer_->in_flight() < room_of_moments() || collect());
    }
    while (good && added < frame.moments.size()) good = collect();
    if (good) out = sum.take();
    const bool empty =
        good && std::ranges::all_of(out->image.coverage, [](float value) { return value == 0; });
    std::set<std::pair<Code, std::string>> told;
    for (const Diagnostic& each : apart.entries()) {
      // a moment may show nothing
      if (each.code == Code("W5006") && !empty) continue;
      if (told.insert({each.code, each.message}).second)
        log.report_file(each.code, {}, each.message, each.hint);
    }
    return good;
  }

  std::size_t room_of_moments() const {
    return drawer_->info().engine == Engine::gl ? Drawer::kMostInFlight : 1;
  }

  // Makes the drawer of an engine the one in use.
  bool prepare(const DrawOptions& draw) {
    OpenReport report;
    const bool gl = draw.engine == Engine::gl;
    std::optional<Drawer>& drawer = drawers_.of(draw);
    const bool fresh = !drawer;
    if (fresh) drawer.emplace(draw);
    drawer_ = &*drawer;
    const bool without = drawer->info().renderer.empty();
    const auto start = std::chrono::steady_clock::now();
    if (!drawer->open(scope_.world, scope_.log)) return false;
    const bool opened = without && !drawer->info().renderer.empty();
    if (opened) report.steps.push_back({"open an OpenGL context", seconds_since(start)});
    scope_.job.poll();
    std::string models;
    for (const world::Instance& target : scope_.world.instances())
      models += (models.empty() ? "" : ", ") + target.model()->name();
    {
      const Stopwatch watch(&report, (gl ? "upload " : "prepare ") + models);
      if (!drawer->prepare(scope_.world, scope_.log, scope_.job)) return false;
    }
    for (const Step& step : report.steps) tell(step);
    if ((fresh || opened) && scope_.options.listener.ready)
      scope_.options.listener.ready(drawer->info());
    return true;
  }

  // Surfaces of closed parts are drawn from outside only.
  void warn_of_inside(const Frame& frame, const world::World& shown) {
    if (frame.camera().projection != world::Projection::perspective) return;
    for (const light::Body& body : shown.bodies()) {
      const Vec3 from = glm::conjugate(body.world_from_body) *
                        (frame.camera().position - body.centre) / body.radii;
      if (glm::dot(from, from) < 1 - 1e-9)
        misplaced_[{Code("W5016"), fmt::format("the camera is inside the planet {}, which is drawn "
                                               "from outside only",
                                               in_quotes(body.name))}]
            .push_back(frame.label);
    }
    evaluation_.update(shown);
    const auto part = world::closed_part_around(shown, evaluation_, frame.camera().position);
    if (!part) return;
    const world::Instance& target = shown[part->target];
    const std::string name = target.name() + "/" + target.model()->node_path(part->node);
    misplaced_[{Code("W5016"), fmt::format("the camera is inside {}, whose surface is visible from "
                                           "outside only",
                                           in_quotes(name))}]
        .push_back(frame.label);
  }

  // Pixels outside the domain of the lens.
  void warn_of_lens(const Frame& frame) {
    const world::Camera& camera = frame.camera();
    if (camera.distortion == nullptr) return;
    const double share = world::share_without_ray(camera);
    if (!(share > 0)) return;
    const double end = camera.distortion->domain();
    const double inside = (1 - 1e-6) * end;
    const auto place = camera.distortion->place(Vec3(std::sin(inside), 0, std::cos(inside)));
    misplaced_[{Code("W5006"),
                fmt::format(
                    "about {:.2g} % of the pixels see nothing: the lens ends {:.4g} degrees "
                    "off its axis{}",
                    100 * share, end / kDegree,
                    place ? fmt::format(", about {:.0f} pixels from the principal point",
                                        glm::length(camera.focal * *place))
                          : "")}]
        .push_back(frame.label);
  }

  // Diagnostics of a view; those of the camera's place are reported of all such views at the end.
  void tell(const DiagnosticLog& said, const std::string& label) {
    forward(said, label, {}, scope_.log, Code("W5006"));
    for (const Diagnostic& each : said.entries())
      if (each.code == Code("W5006") && !scope_.world.empty())
        misplaced_[{each.code, each.message}].push_back(label);
  }

  // One warning for all views in which nothing is seen or the camera is inside, for each reason.
  void warn_of_places() {
    constexpr std::size_t kMostNamed = 8;
    for (auto& [problem, labels] : misplaced_) {
      const auto& [code, reason] = problem;
      const std::size_t count = labels.size();
      if (count == 1) {
        scope_.log.report_file(code, {}, labels[0].empty() ? reason : labels[0] + ": " + reason);
        continue;
      }
      labels.resize(std::min(count, kMostNamed));
      scope_.log.report_file(code, {},
                             fmt::format("{} views: {} ({}{})", count, reason,
                                         fmt::join(labels, ", "), count > kMostNamed ? ", …" : ""));
    }
    misplaced_.clear();
  }

  // Imposters whose flux is far from what was asked: dark but for a few glints, mostly.
  void note_imposters(const Frame& frame, const preview::SamplingReport& report) {
    constexpr double kFar = 0.01, kTimes = 4, kFarthest = 0.1;
    double worst = 0, asked = 0;
    for (const preview::ImposterReport& one : report.imposters) {
      const double far =
          std::clamp(kTimes * one.flux_asked, kFar, std::max(kFarthest, one.flux_asked));
      if (one.flux_error == preview::kNothingLit || one.flux_error <= std::max(far, worst))
        continue;
      worst = one.flux_error;
      asked = one.flux_asked;
    }
    if (worst == 0) return;
    ++uncertain_.views;
    if (worst <= uncertain_.flux_error) return;
    uncertain_ = {uncertain_.views, worst, asked, frame.label, name_of(frame)};
  }

  // One warning for all views.
  void warn_of_imposters() {
    if (uncertain_.views > 0)
      scope_.log.report_file(
          Code("W5008"), uncertain_.output,
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
    if (reached == preview::kNothingLit) return;  // a side in the dark
    // the line of the image states what is less
    constexpr double kLimited = 0.1;
    const bool given = draw.samples > 0 || draw.gl.samples > 0;
    const double silent = report.limited || given ? std::max(asked, kLimited) : asked;
    if (reached <= silent || (given && draw.gl.adaptive)) return;
    if (given) {
      scope_.log.report_file(
          Code("W5008"), name_of(frame),
          fmt::format("{}the estimated error is {:.2g} % with --samples {}",
                      frame.label.empty() ? "" : frame.label + ": ", 100 * reached,
                      draw.gl.samples),
          "--samples auto takes as many as --pixel-error asks for; --imposters always is for small "
          "targets");
      return;
    }
    scope_.log.report_file(
        Code("W5008"), name_of(frame),
        fmt::format("{}the estimated error is {:.2g} %, expected at most {:.2g} % (--pixel-error)",
                    frame.label.empty() ? "" : frame.label + ": ", 100 * reached, 100 * asked),
        report.limited ? "--quality standard limits the time of an image; --pixel-error does not"
                       : "");
  }

  void tell(const Step& step) const {
    if (scope_.options.listener.step) scope_.options.listener.step(step);
  }

  const RunScope scope_;
  Drawers& drawers_;
  Drawer* drawer_ = nullptr;  // in use
  // labels of views, by W5006's and W5016's reasons
  std::map<std::pair<Code, std::string>, std::vector<std::string>> misplaced_;
  world::Evaluation evaluation_;
  struct Uncertain {
    std::size_t views = 0;
    double flux_error = 0, asked = 0;  // of the worst
    std::string label, output;
  } uncertain_;
  Detecting detecting_;
  std::deque<Drawing> drawing_;  // those begun and not taken
  Drawn drawn_;                  // of the first of them, once collected
};

}  // namespace

bool stores_ground_truth(const Frame& frame) {
  if (frame.labels || needs_depth(frame)) return true;  // which are made from it
  const image::FileOptions files = file_options(frame.settings);
  if (frame.outputs.empty()) return image::stores_ground_truth(image::ImageFormat::npz, files);
  return std::any_of(frame.outputs.begin(), frame.outputs.end(), [&](const std::string& output) {
    return image::stores_ground_truth(*image::image_format(output), files);
  });
}

bool write(ImageProduct& product, const std::string& output, DiagnosticLog& log, double* sync) {
  const bool has_ids = image::stores_ground_truth(*image::image_format(output), product.files);
  product.image.metadata.back().second = has_ids ? product.named_record : product.record;
  return image::write_image(output, product.image, product.exposure, log, sync, product.files);
}

void check_output(const CameraInstrument&, const std::string& output, DiagnosticLog& log) {
  if (!image::image_format(output))
    log.report(
        Code("E0202"), {},
        fmt::format("unknown image format of {}, expected .png, .exr, .npy or .npz; of a detector "
                    "also .tif and .fits",
                    in_quotes(output)));
}

std::unique_ptr<InstrumentRun> run_of(const CameraInstrument&, const RunScope& scope,
                                      Drawers& drawers) {
  return std::make_unique<CameraRun>(scope, drawers);
}

}  // namespace panwright::workspace
