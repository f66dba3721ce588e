#include "workspace/session.h"

#include <algorithm>

#include "workspace/internal/forward.h"
#include "workspace/sky_settings.h"

namespace panwright::workspace {

namespace {

constexpr std::size_t kMostWorlds = 4;

// Equal for views of one world.
std::string key_of(const Settings& view) {
  std::string key;
  const auto add = [&](const std::string& text) {
    key += std::to_string(text.size()) + ":" + text;
  };
  for (const std::string& target : *view.targets) add(target);
  key += ";";
  auto defines = *view.define;
  std::sort(defines.begin(), defines.end());
  for (const auto& [name, value] : defines) {
    add(name);
    add(value);
  }
  return key;
}

}  // namespace

ViewSession::Opened* ViewSession::opened(const View& view, const RunListener& listener,
                                         DiagnosticLog& log, const Job& job) {
  const std::string key = key_of(view.settings);
  const auto known = std::find_if(worlds_.begin(), worlds_.end(),
                                  [&](const Opened& each) { return each.key == key; });
  if (known != worlds_.end()) {
    worlds_.splice(worlds_.begin(), worlds_, known);
    return &worlds_.front();
  }
  std::vector<TargetFile> targets;
  RecordSource source;
  source.open = open_;
  source.open.parameters = *view.settings.define;
  for (const std::string& text : *view.settings.targets) {
    targets.push_back(target_file(text));
    source.files.push_back(targets.back().file.string());
  }
  if (!recorded_.empty()) source.files = recorded_;
  OpenReport report;
  auto world = targets.empty() && shows_sky(view.settings)
                   ? Result<world::World>(world::World())
                   : open_world(targets, source.open, log, job, &report);
  if (listener.step)
    for (const Step& step : report.steps) listener.step(step);
  if (!world) {
    if (!view.label.empty())
      log.report(Code("E0203"), {}, view.label + ": its targets cannot be opened");
    return nullptr;
  }
  while (worlds_.size() >= kMostWorlds) worlds_.pop_back();
  worlds_.push_front({key, *std::move(world), std::move(source), nullptr});
  worlds_.front().maker = std::make_unique<FrameMaker>(worlds_.front().world);
  return &worlds_.front();
}

const world::World* ViewSession::world(const View& view, const RunListener& listener,
                                       DiagnosticLog& log, const Job& job) {
  const Opened* found = opened(view, listener, log, job);
  return found == nullptr ? nullptr : &found->world;
}

Result<Frame> ViewSession::frame(const View& view, DiagnosticLog& log) {
  Opened* const open = opened(view, {}, log, {});
  if (open == nullptr) return failed;
  return open->maker->frame(view, log);
}

Result<std::size_t> ViewSession::run(std::span<const View> views, const RunListener& listener,
                                     DiagnosticLog& log, const Job& job) {
  bool good = true;
  for (const View& view : views) good = check(view, log) && good;
  if (!good) return failed;
  for (std::size_t first = 0; first < views.size();) {
    std::size_t end = first + 1;
    while (end < views.size() && key_of(views[end].settings) == key_of(views[first].settings))
      ++end;
    Opened* const open = opened(views[first], listener, log, job);
    if (open == nullptr) return failed;
    std::vector<Frame> frames;
    for (std::size_t i = first; i < end; ++i) {
      auto frame = open->maker->frame(views[i], log);
      good = good && frame;
      if (frame) frames.push_back(*std::move(frame));
    }
    if (!good) return failed;
    RunOptions options;
    options.context = context_;
    options.source = open->source;
    options.listener = listener;
    options.listener.written = [&](Written written) {
      written.frame += first;
      if (listener.written) listener.written(written);
    };
    if (!runner_.run(open->world, frames, options, log, job)) return failed;
    first = end;
  }
  return views.size();
}

}  // namespace panwright::workspace
