#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "image/video.h"
#include "labels/parts.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/dataset_card.h"
#include "tools/dataset_folder.h"
#include "tools/dataset_pack.h"
#include "tools/print.h"
#include "tools/render_report.h"
#include "workspace/record.h"
#include "workspace/session.h"

namespace panwright::tools {

namespace command_dataset {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Frames rendered by one call of the session.
constexpr std::size_t kChunk = 64;

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::string action;
  std::string input;
  std::string output;
  std::string shard = "0/1";
  std::string sheet;
  std::uint64_t per_shard = 1000;
  std::string gl = "auto";
};

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("action", options.action,
           "plan: write the table of frames and what it covers; run: render its frames, or those "
           "that are not whole; check: compare all files with their hashes; pack: write archives")
      .required()
      .one_of({"plan", "run", "check", "pack"})
      .type("ACTION");
  arguments.add("input", options.input, "Plan, a .toml file; of the others the folder of the set")
      .required()
      .type("PLAN|FOLDER");
  arguments
      .add("-o,--output", options.output, "Folder to make: of plan the set, of pack the archives")
      .type("FOLDER");
  arguments
      .add("--shard", options.shard,
           "Part of the set that run renders: I/N is the I-th of N, from 0 (default: 0/1, all)")
      .type("I/N");
  arguments.add("--sheet", options.sheet, "Contact sheet that check makes of PNG images")
      .type("FILE.png");
  arguments.add("--per-shard", options.per_shard, "Frames in an archive of pack (default: 1000)")
      .range(1, 1e9)
      .type("N");
  arguments.add("--gl", options.gl, "OpenGL context: auto (default), egl or osmesa")
      .one_of({"auto", "egl", "osmesa"})
      .type("KIND");
  declare(arguments, options.common);
}

// First and end of the frames of "I/N"; nothing: another text.
std::optional<std::pair<std::size_t, std::size_t>> frames_of_shard(const std::string& text,
                                                                   std::size_t frames) {
  std::uint64_t index = 0, count = 0;
  const char* const end = text.data() + text.size();
  const auto [slash, error] = std::from_chars(text.data(), end, index);
  if (error != std::errc() || slash == end || *slash != '/') return std::nullopt;
  const auto [last, wrong] = std::from_chars(slash + 1, end, count);
  constexpr std::uint64_t kMost = 1'000'000;
  if (wrong != std::errc() || last != end || count > kMost || index >= count) return std::nullopt;
  return std::pair<std::size_t, std::size_t>(frames * index / count, frames * (index + 1) / count);
}

class DatasetCommand {
 public:
  DatasetCommand(const Options& options, CommandContext& context)
      : options_(options), context_(context), log_(context.log()) {}

  void run() {
    const bool makes = options_.action == "plan" || options_.action == "pack";
    if (makes == options_.output.empty()) {
      log_.report(Code("E0201"), {},
                  makes ? options_.action + " needs the folder to make, --output FOLDER"
                        : "--output has no meaning for " + options_.action);
      return;
    }
    context_.result()["action"] = options_.action;
    if (options_.action == "plan") return (void)plan();
    auto set = DatasetFolder::open(options_.input, log_);
    if (!set) return;
    set_ = &*set;
    if (options_.action == "run")
      (void)render();
    else if (check() && options_.action == "pack")
      (void)pack();
  }

 private:
  // Makes the folder of outputs. False: it cannot, or has files.
  bool make_folder() {
    std::error_code error;
    const fs::path folder = options_.output;
    fs::create_directories(folder, error);
    if (!fs::is_directory(folder, error)) {
      log_.report_file(Code("E0103"), folder.string(), "it is no folder, and cannot be made one");
      return false;
    }
    if (fs::is_empty(folder, error)) return true;
    log_.report_file(Code("E8018"), folder.string(), "the folder is not empty",
                     "choose another folder, or move it away");
    return false;
  }

  std::optional<workspace::ViewSession> new_session() {
    auto read = options_.read.opening(log_);
    if (!read) return std::nullopt;
    read->prune = false;  // as in `run`
    return std::optional<workspace::ViewSession>(std::in_place, *std::move(read),
                                                 *preview::context_kind_from_name(options_.gl));
  }

  bool plan() {
    const auto plan = workspace::read_dataset_plan(options_.input, log_);
    if (!plan) return false;
    const auto text = read_file(options_.input, 16 << 20, log_);
    auto session = new_session();
    if (!text || !session) return false;
    const fs::path from = fs::path(options_.input).parent_path();
    DatasetSettings settings;
    settings.view = plan->view;
    std::optional<std::vector<workspace::PlannedFrame>> frames;
    if (!run_job(context_.job(), log_, [&] {
          auto made =
              workspace::plan_frames(*plan, from, *session, settings.view, log_, context_.job());
          if (made) frames = *std::move(made);
          return bool(made);
        }))
      return false;
    const auto defaults = workspace::dataset_settings(settings.view, plan->targets, from, log_);
    if (!defaults || !fill(*plan, *defaults, frames->front(), *session, settings)) return false;
    if (!make_folder()) return false;
    std::error_code ignored;
    settings.folder =
        fs::proximate(fs::weakly_canonical(fs::absolute(options_.input)).parent_path(),
                      fs::weakly_canonical(options_.output), ignored)
            .generic_string();
    const Json coverage = dataset_coverage(*frames);
    std::string rows;
    for (const auto& frame : *frames) rows += frame.view + "\n";
    const std::pair<const char*, std::string> files[] = {
        {"frames.jsonl", rows},
        {"coverage.csv", dataset_table(*frames)},
        {"coverage.json", coverage.dump() + "\n"},
        {"coverage.svg", dataset_plots(coverage)},
        {"README.md", dataset_card(*plan, settings, *text, coverage)},
        {"set.json", dataset_settings_text(settings)}};
    for (const auto& [name, bytes] : files) {
      const fs::path file = fs::path(options_.output) / name;
      if (!write_file(file, as_bytes(bytes), log_)) return false;
      context_.wrote(file.string());
    }
    fs::create_directory(fs::path(options_.output) / "frames", ignored);
    context_.result()["frames"] = frames->size();
    context_.result()["coverage"] = coverage;
    if (options_.common.json) return true;
    print("{}: {}\n", options_.output, counted(frames->size(), "frame"));
    for (const auto& [name, one] : coverage.items())
      print("  {}: {:.4g} to {:.4g} {}, median {:.4g}\n", name, one["least"].get<double>(),
            one["most"].get<double>(), one["unit"].get<std::string>(), one["median"].get<double>());
    return true;
  }

  // What decides the images beside the rows.
  bool fill(const workspace::DatasetPlan& plan, const workspace::Settings& defaults,
            const workspace::PlannedFrame& first, workspace::ViewSession& session,
            DatasetSettings& out) {
    out.program = workspace::recorded_program();
    out.plan = fs::path(options_.input).filename().string();
    out.seed = plan.seed;
    out.targets = plan.targets;
    out.types = plan.types;
    out.labels = plan.labels;
    out.labels_json = plan.labels_json;
    workspace::View view;
    if (!workspace::read_planned_view(first.view, 0, defaults, view, log_)) return false;
    const world::World* world = session.world(view, {}, log_, context_.job());
    if (world == nullptr) return false;
    const auto frame = session.frame(view, log_);
    if (!frame || log_.has_errors()) return false;
    for (const std::string& type : out.types)
      if (frame->imager == nullptr && (type == "tif" || type == "fits")) {
        log_.report(Code("E0202"), {},
                    "types has " + in_quotes(type) +
                        ", which holds numbers of a detector, and the camera has none",
                    "docs/detector.md");
        return false;
      }
    if (out.labels && !labels::named_things(*world, out.labels->options.parts, log_)) return false;
    for (const world::Instance& target : world->instances())
      out.build_ids.emplace_back(target.name(), target.model()->build_id().hex());
    return !defaults.camera_file || read_camera(*defaults.camera_file, out.camera);
  }

  bool read_camera(const std::string& file, std::string& text) {
    auto read = read_file(file, 1 << 20, log_);
    if (read) text = *std::move(read);
    return bool(read);
  }

  bool refuse(const std::string& message, const std::string& hint) {
    log_.report_file(Code("E8018"), options_.input, message, hint);
    return false;
  }

  // Whether what the set was planned with is what is there now.
  bool is_as_planned(const workspace::Settings& defaults, workspace::ViewSession& session,
                     const workspace::RunListener& listener) {
    constexpr const char* kHint = "plan the set again, into another folder";
    const DatasetSettings& settings = set_->settings();
    if (settings.program != workspace::recorded_program())
      return refuse(fmt::format("the set was planned by {}, this is {}", settings.program,
                                workspace::recorded_program()),
                    kHint);
    std::string camera;
    if (defaults.camera_file && !read_camera(*defaults.camera_file, camera)) return false;
    if (camera != settings.camera)
      return refuse(fmt::format("{} is not as it was planned", *defaults.camera_file), kHint);
    workspace::View view;
    if (!workspace::read_planned_view(set_->rows()[0], 0, defaults, view, log_)) return false;
    const world::World* world = session.world(view, listener, log_, context_.job());
    if (world == nullptr) return false;
    for (const auto& [name, id] : settings.build_ids)
      for (const world::Instance& target : world->instances())
        if (target.name() == name && target.model()->build_id().hex() != id)
          return refuse(fmt::format("the model of {} is not that of the plan", in_quotes(name)),
                        kHint);
    return true;
  }

  bool render() {
    const auto shard = frames_of_shard(options_.shard, set_->rows().size());
    if (!shard) {
      log_.report(
          Code("E0201"), {},
          "--shard is " + in_quotes(options_.shard) + ", expected I/N with I from 0 to N-1");
      return false;
    }
    const DatasetSettings& settings = set_->settings();
    const auto defaults = workspace::dataset_settings(
        settings.view, settings.targets, (set_->path() / settings.folder).lexically_normal(), log_);
    auto session = new_session();
    if (!defaults || !session) return false;
    RenderReport report(context_, true, false);
    const workspace::RunListener listener = report.listener();
    if (!is_as_planned(*defaults, *session, listener)) return false;
    std::error_code ignored;
    fs::create_directory(set_->frames_path(), ignored);
    const std::size_t first = shard->first;
    const std::size_t end = shard->second;
    if (first < end && !set_->take(first, end, log_)) return false;
    set_->remove_unfinished(first, end);
    const bool good = run_job(context_.job(), log_, [&] {
      return render_frames(first, end, *defaults, *session, listener);
    });
    context_.result()["kept"] = kept_;
    context_.result()["rendered"] = rendered_;
    if (!options_.common.json)
      fmt::print(stderr, "{} kept, {} rendered\n", counted(kept_, "frame"), rendered_);
    return good;
  }

  bool render_frames(std::size_t first, std::size_t end, const workspace::Settings& defaults,
                     workspace::ViewSession& session, const workspace::RunListener& listener) {
    std::vector<workspace::View> views;
    std::vector<std::size_t> numbers;
    const auto flush = [&] {
      workspace::RunListener own = listener;
      bool finished = true;
      own.written = [&](const workspace::Written& image) {
        finished = finished && set_->finish(numbers[image.frame], log_);
        rendered_ += finished ? 1 : 0;
        if (listener.written) listener.written(image);
      };
      const bool drawn = bool(session.run(views, own, log_, context_.job()));
      views.clear(), numbers.clear();
      return drawn && finished;
    };
    for (std::size_t k = first; k < end; ++k) {
      context_.job().poll();
      if (set_->state_of(k) == FrameState::whole) {
        ++kept_;
      } else {
        // an image with an older row's last file would pass for a whole one
        std::error_code ignored;
        fs::remove(set_->frames_path() / (set_->name(k) + std::string(kFrameExtension)), ignored);
        workspace::View view;
        if (!workspace::read_planned_view(set_->rows()[k], k, defaults, view, log_)) return false;
        std::vector<std::string> outputs = set_->images_of(k);
        for (std::string& output : outputs) output = (set_->frames_path() / output).string();
        view.settings.outputs = std::move(outputs);
        if (set_->settings().labels)
          view.labels = std::make_shared<const workspace::ViewLabels>(workspace::ViewLabels{
              set_->settings().labels, set_->name(k), k, 0, nullptr, nullptr});
        views.push_back(std::move(view));
        numbers.push_back(k);
      }
      if (views.size() == kChunk && !flush()) return false;
    }
    return views.empty() || flush();
  }

  // Compares everything with its hashes. False: frames are not whole.
  bool check() {
    constexpr std::size_t kMostNamed = 8;
    std::vector<std::string> wrong[4];
    const bool done = run_job(context_.job(), log_, [&] {
      Phase phase(context_.job(), "checking", set_->rows().size());
      for (std::size_t k = 0; k < set_->rows().size(); ++k) {
        context_.job().poll();
        wrong[static_cast<std::size_t>(set_->state_of(k))].push_back(set_->name(k));
        phase.advance();
      }
      return true;
    });
    if (!done) return false;
    constexpr std::pair<FrameState, const char*> kStates[] = {
        {FrameState::missing, "missing"},
        {FrameState::changed, "of another row or other settings"},
        {FrameState::damaged, "damaged"}};
    for (const auto& [state, words] : kStates) {
      const auto& names = wrong[static_cast<std::size_t>(state)];
      if (names.empty()) continue;
      const auto named = std::span(names).first(std::min(names.size(), kMostNamed));
      refuse(fmt::format("{} {} {}: {}{}", counted(names.size(), "frame"),
                         names.size() == 1 ? "is" : "are", words, fmt::join(named, ", "),
                         named.size() < names.size() ? ", …" : ""),
             "panwright dataset run makes them");
    }
    const auto strangers = set_->strangers();
    if (!strangers.empty())
      refuse(fmt::format("frames/ has {} of no frame, as {}", counted(strangers.size(), "file"),
                         in_quotes(strangers[0])),
             "move them away");
    const std::size_t whole = wrong[static_cast<std::size_t>(FrameState::whole)].size();
    Json& result = context_.result();
    result["frames"] = set_->rows().size();
    result["whole"] = whole;
    if (!options_.common.json)
      print("{}: {} of {} whole\n", options_.input, whole, counted(set_->rows().size(), "frame"));
    if (!options_.sheet.empty() && whole == set_->rows().size()) make_sheet();
    return !log_.has_errors();
  }

  void make_sheet() {
    constexpr std::size_t kMost = 48;
    constexpr std::uint32_t kSide = 240;  // pixels
    const auto& types = set_->settings().types;
    if (std::ranges::find(types, "png") == types.end()) {
      log_.report(Code("E0201"), {}, "--sheet is made of PNG files, and the set has none");
      return;
    }
    std::vector<fs::path> images;
    for (std::size_t k = 0; k < set_->rows().size(); ++k)
      images.push_back(set_->frames_path() / (set_->name(k) + ".png"));
    if (image::write_sheet(options_.sheet, images, kMost, kSide, log_, context_.job()))
      context_.wrote(options_.sheet);
  }

  bool pack() {
    if (!make_folder()) return false;
    const auto archives =
        pack_dataset(*set_, options_.output, options_.per_shard, log_, context_.job());
    if (!archives) return false;
    for (const std::string& file : *archives) context_.wrote(file);
    context_.result()["archives"] = *archives;
    return true;
  }

  const Options& options_;
  CommandContext& context_;
  DiagnosticLog& log_;
  const DatasetFolder* set_ = nullptr;
  std::size_t kept_ = 0, rendered_ = 0;
};

int run(const Options& options, const Host& host) {
  CommandContext context("dataset", options.common, host);
  context.leave_out(Code("N5002"));
  DatasetCommand(options, context).run();
  return context.finish();
}

}  // namespace
}  // namespace command_dataset

Command dataset_command() {
  return command("dataset", "Plan, render, check and pack data sets for training",
                 command_dataset::declare_all, command_dataset::run);
}

}  // namespace panwright::tools
