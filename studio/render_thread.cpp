#include "studio/render_thread.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "base/clock.h"
#include "base/heap.h"
#include "base/parallel.h"
#include "image/png.h"
#include "image/srgb.h"
#include "studio/edges.h"
#include "studio/play.h"
#include "workspace/drawer.h"
#include "workspace/exposure.h"
#include "workspace/frame.h"

namespace panwright::studio {
namespace {

using RenderClock = std::chrono::steady_clock;

// Time limit of an interactive image, seconds.
constexpr double kInteractiveSeconds = 0.04;
// Time without requests before an image is rendered at full size.
constexpr auto kIdleDelay = std::chrono::milliseconds(120);
// Samples per pixel of the passes of the reference renderer.
constexpr std::array<std::uint32_t, 5> kPasses = {8, 32, 128, 512, 2048};

// Pixel footprint for levels of detail of interactive images, metres: in octaves, away from the
// transitions, where two levels would be drawn. range: metres
double steady_footprint(const world::Camera& camera, double range) {
  const bool perspective = camera.projection == world::Projection::perspective;
  const double pixel = (perspective ? range : 1) / camera.focal.x;
  return std::exp2(std::floor(std::log2(pixel)) + 0.25);
}

// Range of what an image displays, metres.
double range_of(const ViewState& view, const world::Camera& camera, const world::World& world) {
  if (view.own() == nullptr) return view.camera.range;
  double nearest = kFarthest;
  for (const world::Instance& target : world.instances())
    nearest = std::min(nearest, glm::length(target.pose().translation - camera.position));
  return std::max(nearest, kNearest);
}

// The same rays in another number of pixels.
world::Camera resized(world::Camera camera, std::uint32_t width, std::uint32_t height) {
  const Vec2 scale = Vec2(width, height) / Vec2(camera.width, camera.height);
  camera.focal *= scale;
  camera.principal *= scale;
  camera.width = width;
  camera.height = height;
  return camera;
}

// scale: of the sides, in pixels
Result<workspace::Frame> frame_of(const RenderRequest& request, double scale,
                                  workspace::FrameMaker& maker, DiagnosticLog& log) {
  const auto side = [&](std::uint32_t full) {
    return std::max(1u, static_cast<std::uint32_t>(std::lround(full * scale)));
  };
  const std::uint32_t width = side(request.width), height = side(request.height);
  const ViewState& view = request.view;
  if (!view.sized()) return maker.frame(settings_of(view, width, height), log);
  workspace::View changed;
  if (const Moment* own = view.own()) changed = own->view;
  changed.settings = settings_of(view, width, height);
  const bool known = view.own() != nullptr && !view.changes_detector();
  auto frame = known ? Result(view.own()->frame) : maker.frame(changed, log);
  if (frame) frame->camera() = resized(frame->camera(), width, height);
  return frame;
}

// Table of sRGB codes of linear values, finer than the codes.
class SrgbTable {
 public:
  SrgbTable() {
    for (std::size_t i = 0; i < codes_.size(); ++i)
      codes_[i] =
          image::srgb_code((static_cast<double>(i) + 0.5) / static_cast<double>(codes_.size()));
  }
  std::uint8_t operator()(double linear) const {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    return codes_[static_cast<std::size_t>(linear * static_cast<double>(codes_.size()))];
  }

 private:
  std::array<std::uint8_t, 1 << 15> codes_{};
};

}  // namespace

sensor::Imager interactive_imager(sensor::Imager imager, double share) {
  using Stage = sensor::DetectorStage;
  sensor::Optics& optics = imager.optics;
  for (double& each : optics.transmission) each *= share;
  optics.psf_px = optics.jitter_px = optics.diffusion_px = optics.defocus_px = 0;
  optics.diffraction = false;
  optics.kernel = {};
  for (const Stage stage : {Stage::prnu, Stage::smear, Stage::dsnu, Stage::hot, Stage::telegraph,
                            Stage::cosmic, Stage::shot, Stage::read})
    imager.detector.off[static_cast<std::size_t>(stage)] = true;
  imager.detector.blooming = false;
  return imager;
}

std::vector<std::uint8_t> srgb_pixels(const image::Image& image,
                                      const image::PngExposure& exposure) {
  std::vector<std::uint8_t> out(4 * image.pixels(), 255);
  if (exposure.photo) {
    const std::vector<std::uint8_t> rgb = image::png_codes(image, exposure);
    for (std::size_t i = 0; i < image.pixels(); ++i) std::copy_n(&rgb[3 * i], 3, &out[4 * i]);
    return out;
  }
  static const SrgbTable codes;
  const double gain = kPi * std::exp2(exposure.stops);
  parallel_for(image.height, [&](std::size_t row) {
    for (std::size_t i = row * image.width; i < (row + 1) * image.width; ++i) {
      for (std::size_t k = 0; k < 3; ++k) out[4 * i + k] = codes(gain * image.radiance[3 * i + k]);
    }
  });
  return out;
}

// Reductions of interactive images.
struct RenderThread::Effort {
  double scale;  // pixels per side, over those of the exact image; few values: each has its buffers
  double level_scale;  // factor on the pixel footprint of levels of detail
  unsigned shadow_side;
};

constexpr std::array<RenderThread::Effort, 7> RenderThread::kEfforts = {{{1, 1, 2048},
                                                                         {0.7, 1, 2048},
                                                                         {0.5, 1, 1024},
                                                                         {0.5, 4, 1024},
                                                                         {0.35, 4, 512},
                                                                         {0.25, 4, 512},
                                                                         {0.25, 16, 256}}};

// Renderer, world and last results of the thread.
struct RenderThread::Resources {
  std::optional<workspace::Drawer> drawer;
  std::shared_ptr<const world::World> source;  // `world` is a copy of it
  world::World world;
  std::optional<workspace::FrameMaker> maker;  // of `source`; keeps maps and catalogues
  workspace::Frame frame;                      // of the last image
  workspace::Detecting detecting, interactive_detecting;
  bool photo = false;  // its tone
  std::vector<std::pair<std::size_t, std::uint32_t>> hidden;
  std::optional<double> ev;  // found from the last exact image
  preview::Reference reference;
  std::shared_ptr<const RenderResult> exact;

  workspace::Detecting& detecting_of(bool whole) {
    return whole ? detecting : interactive_detecting;
  }

  // Copies the world where it has changed, and hides nodes.
  void update(const RenderRequest& request) {
    if (source != request.world) {
      source = request.world;
      world = *source;
      maker.emplace(*source);
      hidden.clear();
    }
    if (hidden == request.hidden) return;
    for (const auto& [target, node] : hidden) world.set_node_visible(target, node, true);
    for (const auto& [target, node] : request.hidden) world.set_node_visible(target, node, false);
    hidden = request.hidden;
  }
};

RenderThread::RenderThread(preview::ContextKind context, std::function<void()> notify)
    : context_(context), notify_(std::move(notify)) {
  share_heap();
  thread_ = std::thread([this] { work(); });
}

RenderThread::~RenderThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    if (job_.state()) job_.cancel();
  }
  wake_.notify_all();
  thread_.join();
}

void RenderThread::request(RenderRequest request) {
  {
    const std::lock_guard lock(mutex_);
    if (pending_ ? *pending_ == request : current_ && *current_ == request) return;
    pending_ = std::move(request);
    current_.reset();
    if ((status_.exact || status_.comparing) && job_.state()) job_.cancel();
    status_.drawing = true;
  }
  wake_.notify_all();
}

std::shared_ptr<const RenderResult> RenderThread::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, nullptr);
}

RenderThread::Status RenderThread::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void RenderThread::adapt(double seconds) {
  status_.frame_seconds +=
      (seconds - status_.frame_seconds) * (status_.interactive_count > 1 ? 0.3 : 1);
  if (seconds > kInteractiveSeconds && effort_ + 1 < kEfforts.size())
    effort_ = std::min(effort_ + (seconds > 2 * kInteractiveSeconds ? 2 : 1), kEfforts.size() - 1);
  else if (seconds < 0.5 * kInteractiveSeconds && effort_ > 0)
    --effort_;
  status_.resolution_scale = kEfforts[effort_].scale;
  status_.level_scale = kEfforts[effort_].level_scale;
}

void RenderThread::work() {
  Resources resources;
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto anything = [&] { return pending_ || ending_; };
    const bool still = !current_ || quality_ == RenderResult::Quality::exact;
    const bool compares =
        still && current_ && current_->reference_bounces && traced_ < kPasses.size();
    status_.comparing = compares;
    if (still && !compares)
      wake_.wait(lock, anything);
    else if (!compares)
      wake_.wait_for(lock, kIdleDelay, anything);
    if (ending_) return;
    if (compares && !pending_) {
      const RenderRequest request = *current_;
      job_ = Job(JobOptions{});
      const Job job = job_;
      lock.unlock();
      trace(resources, request, job);
      lock.lock();
      job_ = Job();
      ++traced_;
      continue;
    }
    traced_ = 0;
    status_.comparing = false;
    RenderResult::Quality quality = RenderResult::Quality::interactive;
    if (pending_)
      current_ = std::exchange(pending_, std::nullopt);
    else
      quality = static_cast<RenderResult::Quality>(static_cast<int>(quality_) + 1);
    const RenderRequest request = *current_;
    status_.exact = quality == RenderResult::Quality::exact;
    status_.drawing = true;
    job_ = Job(JobOptions{});
    const Job job = job_;
    lock.unlock();
    const bool full = render(resources, request, quality, job);
    lock.lock();
    job_ = Job();
    quality_ = quality == RenderResult::Quality::interactive && full
                   ? RenderResult::Quality::full_size
                   : quality;
    status_.exact = false;
    status_.drawing = pending_ || quality_ != RenderResult::Quality::exact;
  }
}

// Draws one image; none: see the log.
std::optional<workspace::Drawn> RenderThread::draw(Resources& resources,
                                                   const RenderRequest& request, bool exact,
                                                   const Effort& effort, DiagnosticLog& log,
                                                   const Job& job) {
  resources.update(request);
  auto frame = frame_of(request, effort.scale, *resources.maker, log);
  if (!frame) return std::nullopt;
  workspace::DrawOptions options = workspace::draw_options(frame->settings, context_);
  if (!resources.drawer) resources.drawer.emplace(options);
  if (resources.drawer->info().renderer.empty()) {
    const bool good = resources.drawer->open(*request.world, log);
    const std::lock_guard lock(mutex_);
    status_.renderer = resources.drawer->info().renderer;
    if (!good && !log.entries().empty()) status_.problem = log.entries()[0].message;
    if (!good) return std::nullopt;
  }
  resources.frame = *std::move(frame);
  workspace::Frame& shown = resources.frame;
  if (shown.imager != nullptr && !exact)
    shown.imager = std::make_shared<const sensor::Imager>(
        interactive_imager(*shown.imager, 1.0 * shown.camera().width * shown.camera().height /
                                              (1.0 * request.width * request.height)));
  workspace::show(shown, *request.world, resources.world);
  resources.photo = options.photo;
  if (!exact) {
    options.samples = 1;
    options.gl.shadows = preview::Shadows::hard;
    options.gl.imposters = preview::Imposters::off;
    options.indirect = workspace::Indirect::off;
    options.gl.shadow_side =
        std::min(options.gl.shadow_side.value_or(effort.shadow_side), effort.shadow_side);
    const double range = range_of(request.view, shown.camera(), resources.world);
    options.gl.level_pixel = effort.level_scale * steady_footprint(shown.camera(), range);
  }
  const world::Camera camera = resources.detecting_of(exact).drawn_camera(shown, options);
  resources.drawer->set_options(options);
  auto drawn = resources.drawer->draw(resources.world, camera,
                                      exact || workspace::needs_depth(resources.frame), log, job);
  if (!drawn) return std::nullopt;
  return *std::move(drawn);
}

// Returns whether nothing was reduced.
bool RenderThread::render(Resources& resources, const RenderRequest& request,
                          RenderResult::Quality quality, const Job& job) {
  const bool exact = quality == RenderResult::Quality::exact;
  const auto start = RenderClock::now();
  auto result = std::make_shared<RenderResult>();
  result->request = request;
  result->quality = quality;
  result->exact = exact;
  DiagnosticLog log;
  Effort effort = kEfforts[0];
  if (quality == RenderResult::Quality::interactive) {
    const std::lock_guard lock(mutex_);
    effort = kEfforts[effort_];
    effort.scale *= request.shown_scale;
    result->level_scale = effort.level_scale;
  }
  const bool full = effort.scale == 1 && effort.level_scale == 1;
  std::optional<workspace::Drawn> drawn;
  try {
    drawn = draw(resources, request, exact, effort, log, job);
    result->imager = resources.frame.imager;
    if (drawn && result->imager != nullptr)
      result->detected =
          resources.detecting_of(exact).develop(resources.frame, false, drawn->image, log);
  } catch (const std::exception&) {
    report_exception(log);
    resources.drawer.reset();  // what it holds may be half made
  }
  if (job.cancelled()) return full;
  result->failed = !drawn;
  // a lost context cannot be used again: the next image gets a new one
  if (!drawn && log.contains(Code("E5001"))) resources.drawer.reset();
  // warnings of interactive images are about what was left out
  result->messages = messages_of(log);
  if (!exact)
    std::erase_if(result->messages,
                  [](const Message& each) { return each.severity != Severity::error; });
  if (drawn) {
    result->image = std::move(drawn->image);
    if (drawn->sampling) result->sampling = *drawn->sampling;
    result->between = drawn->between;
    const double of_sun = workspace::stops_of_sun(resources.world);
    if (request.view.auto_ev && (exact || !resources.ev))
      resources.ev = workspace::auto_exposure(result->image, of_sun);
    result->ev = request.view.auto_ev ? *resources.ev : request.view.ev;
    result->exposure = {result->ev - of_sun, resources.photo};
    result->rgba = result->imager != nullptr ? dn_pixels(result->image)
                                             : srgb_pixels(result->image, result->exposure);
    const world::Camera& camera = resources.frame.camera();
    if (exact) result->details = details_of(resources.world, camera);
    if (exact && request.edges)
      result->edges = edges_of(resources.world, camera, result->image, job);
  }
  result->seconds = seconds_since(start);
  publish(resources, std::move(result));
  return full;
}

void RenderThread::publish(Resources& resources, std::shared_ptr<RenderResult> result) {
  const std::lock_guard lock(mutex_);
  if (result->exact) ++status_.exact_count;
  if (result->quality == RenderResult::Quality::interactive) {
    ++status_.interactive_count;
    adapt(result->seconds);
    count_interactive();
  } else {
    last_interactive_ = {};
  }
  if (ending_) return;
  if (result->exact) resources.exact = result;
  result_ = std::move(result);
  if (notify_) notify_();
}

void RenderThread::count_interactive() {
  const RenderClock::time_point now = RenderClock::now();
  if (last_interactive_ != RenderClock::time_point{}) {
    interactive_seconds_ += std::chrono::duration<double>(now - last_interactive_).count();
    status_.rate = static_cast<double>(++interactive_intervals_) / interactive_seconds_;
  }
  last_interactive_ = now;
}

// One more pass over the last exact image.
void RenderThread::trace(Resources& resources, const RenderRequest& request, const Job& job) {
  if (!resources.exact || resources.exact->failed) return;
  const auto start = RenderClock::now();
  DiagnosticLog log;
  auto frame = frame_of(request, 1, *resources.maker, log);
  if (!frame) return;
  preview::ReferenceOptions options;
  options.samples = kPasses[traced_];
  options.bounces = *request.reference_bounces;
  auto image = resources.reference.render(resources.world, frame->camera(), options, log, job);
  if (job.cancelled()) return;
  auto result = std::make_shared<RenderResult>(*resources.exact);
  if (!image) {
    // the exact image stays, with the messages
    const std::vector<Message> more = messages_of(log);
    result->messages.insert(result->messages.end(), more.begin(), more.end());
    const std::lock_guard lock(mutex_);
    traced_ = kPasses.size();
    if (!ending_ && !pending_) result_ = std::move(result);
    return;
  }
  result->reference_samples = options.samples;
  result->reference_seconds = seconds_since(start);
  result->comparison = compared(result->image, *image);
  result->reference = std::make_shared<const preview::ReferenceImage>(*std::move(image));
  const std::lock_guard lock(mutex_);
  if (ending_ || pending_) return;
  result_ = std::move(result);
  if (notify_) notify_();
}

}  // namespace panwright::studio
