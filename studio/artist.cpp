#include "studio/artist.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "base/parallel.h"
#include "base/srgb.h"
#include "studio/edges.h"
#include "workspace/drawer.h"
#include "workspace/exposure.h"

namespace panwright::studio {
namespace {

using Clock = std::chrono::steady_clock;

// Of images that follow the mouse: the time they may take, and what is left out for that.
constexpr double kFollowSeconds = 0.04;
struct Effort {
  double
      scale;  // pixels in parts of the exact image's, a side; few sizes: buffers are made for each
  double coarser;  // levels of detail as for pixels so many times as wide
  unsigned shadow_side;
};
constexpr std::array<Effort, 7> kEfforts = {{{1, 1, 2048},
                                             {0.7, 1, 2048},
                                             {0.5, 1, 1024},
                                             {0.5, 4, 1024},
                                             {0.35, 4, 512},
                                             {0.25, 4, 512},
                                             {0.25, 16, 256}}};
// without orders for so long the image is drawn exactly
constexpr auto kStill = std::chrono::milliseconds(120);
// of the reference, for each pixel
constexpr std::array<std::uint32_t, 5> kPasses = {8, 32, 128, 512, 2048};

// What levels of detail go by while images follow the mouse: metres that a pixel sees, in steps
// between those where levels fade into each other, which draws both.
double steady_level(const Eye& eye, double width) {
  const double pixel = 2 * eye.range * std::tan(eye.fov * kDegree / 2) / width;
  return std::exp2(std::floor(std::log2(pixel)) + 0.25);
}

// Codes of linear values, finer than codes are apart.
class Codes {
 public:
  Codes() {
    for (std::size_t i = 0; i < codes_.size(); ++i)
      codes_[i] = srgb_code((static_cast<double>(i) + 0.5) / static_cast<double>(codes_.size()));
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

std::vector<std::uint8_t> shown_pixels(const preview::Image& image, double ev) {
  static const Codes codes;
  const double gain = kPi * std::exp2(ev);
  std::vector<std::uint8_t> out(4 * image.pixels());
  parallel_for(image.height, [&](std::size_t row) {
    for (std::size_t i = row * image.width; i < (row + 1) * image.width; ++i) {
      for (std::size_t k = 0; k < 3; ++k) out[4 * i + k] = codes(gain * image.radiance[3 * i + k]);
      out[4 * i + 3] = 255;
    }
  });
  return out;
}

// What lives on the drawing thread.
struct Artist::Easel {
  std::optional<workspace::Drawer> drawer;
  std::shared_ptr<const world::World> of;  // what `shown` was copied from
  world::World shown;
  std::vector<std::pair<std::size_t, std::uint32_t>> hidden;
  std::optional<double> ev;  // of the last exact image that found it
  preview::Reference reference;
  std::shared_ptr<const DrawnImage> exact;  // the last one

  void take(const Order& order) {
    if (of != order.world) {
      of = order.world;
      shown = *of;
      hidden.clear();
    }
    if (hidden == order.hidden) return;
    for (const auto& [target, node] : hidden) shown.set_node_visible(target, node, true);
    for (const auto& [target, node] : order.hidden) shown.set_node_visible(target, node, false);
    hidden = order.hidden;
  }
};

Artist::Artist(preview::ContextKind context, std::function<void()> news)
    : context_(context), news_(std::move(news)) {
  thread_ = std::thread([this] { work(); });
}

Artist::~Artist() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    if (job_.state()) job_.cancel();
  }
  wake_.notify_all();
  thread_.join();
}

void Artist::draw(Order order) {
  {
    const std::lock_guard lock(mutex_);
    if (wanted_ ? *wanted_ == order : drawn_ && *drawn_ == order) return;
    wanted_ = std::move(order);
    drawn_.reset();
    if ((status_.exact || status_.comparing) && job_.state()) job_.cancel();
    status_.drawing = true;
  }
  wake_.notify_all();
}

std::shared_ptr<const DrawnImage> Artist::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, nullptr);
}

Artist::Status Artist::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void Artist::adapt(double seconds) {
  status_.frame_seconds += (seconds - status_.frame_seconds) * (status_.quick > 1 ? 0.3 : 1);
  if (seconds > kFollowSeconds && effort_ + 1 < kEfforts.size())
    effort_ = std::min(effort_ + (seconds > 2 * kFollowSeconds ? 2 : 1), kEfforts.size() - 1);
  else if (seconds < 0.5 * kFollowSeconds && effort_ > 0)
    --effort_;
  status_.scale = kEfforts[effort_].scale;
  status_.coarser = kEfforts[effort_].coarser;
}

void Artist::work() {
  Easel easel;
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto anything = [&] { return wanted_ || ending_; };
    const bool still = !drawn_ || stage_ == DrawnImage::Stage::exact;
    const bool compares = still && drawn_ && drawn_->reference_bounces && traced_ < kPasses.size();
    status_.comparing = compares;
    if (still && !compares)
      wake_.wait(lock, anything);
    else if (!compares)
      wake_.wait_for(lock, kStill, anything);
    if (ending_) return;
    if (compares && !wanted_) {
      const Order order = *drawn_;
      job_ = Job(JobOptions{});
      const Job job = job_;
      lock.unlock();
      trace(easel, order, job);
      lock.lock();
      job_ = Job();
      ++traced_;
      continue;
    }
    traced_ = 0;
    status_.comparing = false;
    DrawnImage::Stage stage = DrawnImage::Stage::following;
    if (wanted_)
      drawn_ = std::exchange(wanted_, std::nullopt);
    else
      stage = static_cast<DrawnImage::Stage>(static_cast<int>(stage_) + 1);
    const Order order = *drawn_;
    status_.exact = stage == DrawnImage::Stage::exact;
    status_.drawing = true;
    job_ = Job(JobOptions{});
    const Job job = job_;
    lock.unlock();
    const bool whole = paint(easel, order, stage, job);
    lock.lock();
    job_ = Job();
    stage_ = stage == DrawnImage::Stage::following && whole ? DrawnImage::Stage::whole : stage;
    status_.exact = false;
    status_.drawing = wanted_ || stage_ != DrawnImage::Stage::exact;
  }
}

// Whether nothing was left out of an image that follows.
bool Artist::paint(Easel& easel, const Order& order, DrawnImage::Stage stage, const Job& job) {
  const bool exact = stage == DrawnImage::Stage::exact;
  const auto start = Clock::now();
  auto finished = std::make_shared<DrawnImage>();
  finished->order = order;
  finished->stage = stage;
  finished->exact = exact;
  DiagnosticLog log;
  Effort effort = kEfforts[0];
  if (stage == DrawnImage::Stage::following) {
    const std::lock_guard lock(mutex_);
    effort = kEfforts[effort_];
    finished->coarser = effort.coarser;
  }
  const double scale = effort.scale;
  const auto side = [&](std::uint32_t whole) {
    return std::max(1u, static_cast<std::uint32_t>(std::lround(whole * scale)));
  };
  const workspace::ViewText text =
      view_text(order.eye, side(order.width), side(order.height));
  easel.take(order);
  const auto view = workspace::ViewMaker(*order.world).view(text, log);
  auto options = workspace::draw_options(text, context_, log);
  bool ok = view && options;
  if (ok && !easel.drawer) {
    auto made = workspace::Drawer::create(*options, log);
    if (made) easel.drawer.emplace(*std::move(made));
    const std::lock_guard lock(mutex_);
    if (easel.drawer) status_.renderer = easel.drawer->info().renderer;
    ok = easel.drawer.has_value();
    if (!ok && !log.entries().empty()) status_.problem = log.entries()[0].message;
  }
  std::optional<workspace::Drawn> drawn;
  if (ok) {
    if (!exact) {
      options->samples = 1;
      options->gl.shadows = preview::Shadows::hard;
      options->gl.imposters = preview::Imposters::off;
      options->gl.shadow_side =
          std::min(options->gl.shadow_side.value_or(effort.shadow_side), effort.shadow_side);
      options->gl.level_pixel = finished->coarser * steady_level(order.eye, side(order.width));
    }
    easel.drawer->set_options(*options);
    workspace::show(*view, *order.world, easel.shown);
    if (auto result = easel.drawer->draw(easel.shown, view->camera, exact, log, job))
      drawn = *std::move(result);
  }
  const bool whole = scale == 1 && finished->coarser == 1;
  if (job.cancelled()) return whole;
  finished->failed = !drawn;
  // a context that was lost takes nothing any more: the next image has another one
  if (!drawn && log.contains(Code::E5001)) easel.drawer.reset();
  // what an image that follows warns of is what it left out
  finished->messages = messages_of(log);
  if (!exact)
    std::erase_if(finished->messages,
                  [](const Message& each) { return each.severity != Severity::error; });
  if (drawn) {
    finished->image = std::move(drawn->image);
    if (drawn->sampling) finished->sampling = *drawn->sampling;
    if (order.eye.auto_ev && (exact || !easel.ev))
      easel.ev = workspace::auto_exposure(finished->image, 0);
    finished->ev = order.eye.auto_ev ? *easel.ev : order.eye.ev;
    finished->rgba = shown_pixels(finished->image, finished->ev);
    if (exact) finished->details = details_of(easel.shown, view->camera);
    if (exact && order.edges)
      finished->edges = edges_of(easel.shown, view->camera, finished->image, job);
  }
  finished->seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const std::lock_guard lock(mutex_);
  if (exact)
    ++status_.exact_count;
  if (stage == DrawnImage::Stage::following) {
    ++status_.quick;
    adapt(finished->seconds);
    count_follower();
  } else {
    followed_ = {};
  }
  if (ending_) return whole;
  if (exact) easel.exact = finished;
  done_ = std::move(finished);
  if (news_) news_();
  return whole;
}

void Artist::count_follower() {
  const Clock::time_point now = Clock::now();
  if (followed_ != Clock::time_point{}) {
    following_seconds_ += std::chrono::duration<double>(now - followed_).count();
    status_.rate = static_cast<double>(++followers_) / following_seconds_;
  }
  followed_ = now;
}

// One more pass over the last exact image.
void Artist::trace(Easel& easel, const Order& order, const Job& job) {
  if (!easel.exact || easel.exact->failed) return;
  const auto start = Clock::now();
  DiagnosticLog log;
  const auto view = workspace::ViewMaker(*order.world).view(view_text(order.eye, order.width, order.height), log);
  if (!view) return;
  preview::ReferenceOptions options;
  options.samples = kPasses[traced_];
  options.bounces = *order.reference_bounces;
  auto image = easel.reference.render(easel.shown, view->camera, options, log, job);
  if (job.cancelled()) return;
  auto finished = std::make_shared<DrawnImage>(*easel.exact);
  if (!image) {
    // said beside the exact image, which stays
    const std::vector<Message> more = messages_of(log);
    finished->messages.insert(finished->messages.end(), more.begin(), more.end());
    const std::lock_guard lock(mutex_);
    traced_ = kPasses.size();
    if (!ending_ && !wanted_) done_ = std::move(finished);
    return;
  }
  finished->reference_samples = options.samples;
  finished->reference_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  finished->comparison = compared(finished->image, *image);
  finished->reference = std::make_shared<const preview::ReferenceImage>(*std::move(image));
  const std::lock_guard lock(mutex_);
  if (ending_ || wanted_) return;
  done_ = std::move(finished);
  if (news_) news_();
}

}  // namespace panwright::studio
