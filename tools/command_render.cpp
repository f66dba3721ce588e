#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/render_report.h"
#include "workspace/session.h"
#include "workspace/sky_settings.h"

namespace panwright::tools {

namespace command_render {
namespace {

using workspace::SettingId;

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::vector<std::string> targets;  // FILE or NAME=FILE
  ViewOptions view;
  std::string views;  // file of many views, .json or .jsonl; "-": JSON Lines on standard input
  std::string again;  // image whose record is followed
  std::string gl = "auto";
  bool labels = false;
  bool explain = false;
};

void declare_files(Arguments& arguments, Options& options) {
  arguments
      .add(
          "--views", options.views,
          "JSON list of views, or .jsonl, one a line (docs/views.md). -: read one view a line from "
          "standard input, write one reply a line to standard output")
      .type("FILE.json|FILE.jsonl|-");
  arguments
      .add("--again", options.again,
           "Repeat an image from its record (.png, .exr, .npz); other options override the record")
      .type("IMAGE");
}

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("input", options.targets,
           "Targets: .pan, .pxn or CAD files; NAME=FILE names a target (default: the file's name)")
      .type("[NAME=]FILE…");
  for (const SettingId id : workspace::kCommandOrder) {
    if (id == SettingId::line_time || id == SettingId::tdi) continue;  // of scenarios
    if (id == SettingId::layers)
      arguments.flag("--labels", options.labels,
                     "Write labels beside the image: masks, boxes, poses and keypoints "
                     "(docs/labels.md)");
    if (id == SettingId::quality) declare_files(arguments, options);
    if (id == SettingId::max_image_memory)
      arguments.flag("--explain", options.explain,
                     "Print how each target was drawn, its estimated error and its time");
    declare(arguments, options.view, id);
  }
  arguments.add("--gl", options.gl, "OpenGL context: auto (default), egl or osmesa")
      .one_of({"auto", "egl", "osmesa"})
      .type("KIND");
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

// What is to be rendered.
struct Work {
  std::vector<workspace::View> views;  // with --views -: one, for what lines leave out
  workspace::OpenOptions open;
  preview::ContextKind context = preview::ContextKind::automatic;
  std::optional<workspace::Record> record;  // of --again
  std::vector<std::string> recorded_files;  // empty: those of the views
};

// The view of a record, with what the command line replaces.
bool follow_record(const Options& options, workspace::Settings typed, Work& work,
                   DiagnosticLog& log) {
  auto record = workspace::read_record(options.again, log);
  if (!record) return false;
  if (!typed.outputs) {
    const std::filesystem::path image = options.again;
    typed.outputs = {image.stem().string() + ".again" + image.extension().string()};
  }
  if (!typed.targets) {
    std::vector<std::string> targets;
    for (const workspace::RecordedTarget& target : record->targets) {
      if (target.file.empty()) {
        log.report_file(Code("E0207"), options.again,
                        "the record does not name the file of " + in_quotes(target.name),
                        "name it, as in: render --again IMAGE " + target.name + "=FILE");
        return false;
      }
      const auto found = workspace::find_recorded(target.file, options.again);
      std::error_code ignored;
      if (!std::filesystem::exists(found, ignored)) {
        log.report_file(Code("E0101"), options.again,
                        fmt::format("model {} of {} not found in the working directory, the folder "
                                    "of the image or those above it",
                                    in_quotes(target.file), in_quotes(target.name)),
                        "name it, as in: render --again IMAGE " + target.name + "=FILE");
        return false;
      }
      targets.push_back(target.name + "=" + found.string());
      work.recorded_files.push_back(target.file);
    }
    typed.targets = std::move(targets);
  }
  const workspace::OpenOptions given = work.open;
  work.open = record->open;
  work.open.max_input = given.max_input;
  work.open.max_triangles = given.max_triangles;
  work.open.cache = given.cache;
  if (given.max_error) work.open.max_error = given.max_error;
  if (!given.budget.empty()) work.open.budget = given.budget;
  if (options.gl == "auto") work.context = *preview::context_kind_from_name(record->context);
  const bool lens = typed.fov || typed.ifov || typed.intrinsics || typed.ortho;
  workspace::View view;
  view.field_of_view = record->view.field_of_view && !lens;
  if (view.field_of_view && typed.size)
    workspace::keep_field_of_view(record->view.settings, *typed.size);
  view.settings = workspace::with_defaults(std::move(typed), record->view.settings);
  work.views = {std::move(view)};
  work.record = *std::move(record);
  return true;
}

bool check_usage(const Options& options, DiagnosticLog& log) {
  const auto refuse = [&](const char* message) { log.report(Code("E0201"), {}, message); };
  const std::size_t errors = log.errors();
  if (!options.views.empty() && options.view.given(SettingId::output))
    refuse("-o cannot be combined with --views; each view has its own output");
  if (!options.views.empty() && !options.again.empty())
    refuse("--again cannot be combined with --views");
  if (options.views == "-" && options.common.json)
    refuse("--json cannot be combined with --views -, whose replies are JSON");
  if (options.views == "-" && options.labels)
    refuse("--labels cannot be combined with --views -, expected --views FILE.json");
  return log.errors() == errors;
}

Result<Work> work_of(const Options& options, DiagnosticLog& log) {
  if (!check_usage(options, log)) return failed;
  auto read = options.read.opening(log);
  auto typed = options.view.settings(log);
  if (!read || !typed) return failed;
  if (options.targets.empty() && options.views.empty() && options.again.empty() &&
      !workspace::shows_sky(*typed)) {
    log.report(Code("E0201"), {},
               "no model is given, expected FILE, as in: panwright render model.pan -o image.png");
    return failed;
  }
  Work work;
  work.context = *preview::context_kind_from_name(options.gl);
  if (!options.targets.empty()) typed->targets = options.targets;
  if (!read->parameters.empty()) typed->define = std::exchange(read->parameters, {});
  work.open = *std::move(read);
  if (!options.again.empty()) {
    if (!follow_record(options, *std::move(typed), work, log)) return failed;
  } else if (options.views == "-") {
    work.views = {*std::move(typed)};
  } else if (!options.views.empty()) {
    auto views = workspace::read_views(options.views, *typed, log);
    if (!views) return failed;
    work.views = *std::move(views);
    const std::size_t errors = log.errors();
    for (const workspace::View& view : work.views)
      if (!view.settings.targets && !workspace::shows_sky(view.settings))
        log.report_file(Code("E0203"), view.file, view.label + ": no targets, and none are given",
                        "name a model on the command line, or as \"targets\"");
    if (log.errors() != errors) return failed;
  } else {
    if (!typed->outputs) {
      const auto first = options.targets.empty() ? std::filesystem::path("sky")
                                                 : workspace::target_file(options.targets[0]).file;
      typed->outputs = {std::filesystem::path(first).filename().replace_extension(".png").string()};
    }
    work.views = {*std::move(typed)};
  }
  // hidden surfaces cost an image less than their removal
  work.open.prune = false;
  return work;
}

// Labels of each view, named as its first file.
void add_labels(std::vector<workspace::View>& views) {
  const auto labelling = std::make_shared<const workspace::Labelling>();
  for (std::size_t k = 0; k < views.size(); ++k) {
    const auto& outputs = views[k].settings.outputs;
    if (outputs && !outputs->empty())
      views[k].labels = std::make_shared<const workspace::ViewLabels>(
          workspace::ViewLabels{labelling, std::filesystem::path(outputs->front()).stem().string(),
                                k, 0, nullptr, nullptr});
  }
}

int run(const Options& options, const Host& host) {
  CommandContext context("render", options.common, host);
  DiagnosticLog& log = context.log();
  auto work = work_of(options, log);
  if (!work) return context.finish();
  if (options.labels) add_labels(work->views);
  const auto is_text = [](const std::string& target) {
    return workspace::extension_of(workspace::target_file(target).file) == ".pxn";
  };
  if (!options.explain) context.leave_out(Code("N5002"));
  const auto& targets = *work->views[0].settings.targets;
  if (std::all_of(targets.begin(), targets.end(), is_text)) context.summarise_imports();
  workspace::ViewSession session(work->open, work->context);
  session.set_recorded_files(work->recorded_files);
  RenderReport report(context, !options.views.empty(), options.explain);
  if (options.views == "-")
    return context.finish(
        serve_views(session, work->views[0].settings, report.listener(), context));
  if (work->views.size() == 1 && !options.view.given(SettingId::output) && options.views.empty() &&
      !work->record) {
    const world::World* world =
        session.world(work->views[0], report.listener(), log, context.job());
    // what could be read is drawn only where the user named the output
    if (world == nullptr || log.has_errors()) {
      if (world != nullptr) context.left_out(CommandContext::LeftOut::unnamed);
      return context.finish();
    }
  }
  if (work->record) {
    const world::World* world =
        session.world(work->views[0], report.listener(), log, context.job());
    if (world == nullptr) return context.finish();
    workspace::compare_with_record(*work->record, *world, options.again, log);
  }
  if (session.run(work->views, report.listener(), log, context.job())) report.summary();
  return context.finish();
}

}  // namespace
}  // namespace command_render

Command render_command() {
  return command("render", "Render one or more models", command_render::declare_all,
                 command_render::run);
}

}  // namespace panwright::tools
