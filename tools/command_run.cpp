#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file.h"
#include "base/text.h"
#include "labels/convert.h"
#include "labels/parts.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/frame_json.h"
#include "tools/render_report.h"
#include "tools/run_album.h"
#include "tools/run_folder.h"
#include "tools/run_instruments.h"
#include "tools/scenario_options.h"
#include "workspace/lamp_text.h"
#include "workspace/record.h"
#include "workspace/session.h"
#include "workspace/sky_settings.h"

namespace panwright::tools {

namespace command_run {
namespace {

using Json = nlohmann::ordered_json;
using workspace::SettingId;

// Frames rendered by one call of the session.
constexpr std::size_t kChunk = 256;
constexpr std::size_t kExposedChunk = 16;  // of frames that have up to a thousand moments each

struct Options {
  CommonOptions common;
  ReadOptions read;
  ScenarioInput input;
  std::vector<std::string> targets;  // FILE or NAME=FILE
  ViewOptions view;
  std::string folder;
  std::vector<std::string> types;  // extensions; empty: png
  bool labels = false;
  bool resume = false;
  AlbumOptions album;
  std::string gl = "auto";
};

// Settings that frames give, or that name one image.
bool is_of_frames(SettingId id) {
  constexpr SettingId kOfFrames[] = {SettingId::output, SettingId::pose, SettingId::joint,
                                     SettingId::camera_frame};
  return std::ranges::find(kOfFrames, id) != std::end(kOfFrames);
}

void declare_all(Arguments& arguments, Options& options) {
  declare(arguments, options.input);
  arguments
      .add("-o,--output", options.folder,
           "Folder of the images, of frames.jsonl, a line for each frame, and run.json, the "
           "settings")
      .required()
      .type("FOLDER");
  arguments
      .add(
          "--target", options.targets,
          "Model of a target, instead of the scenario's: a .pan, .pxn or CAD file; may be repeated")
      .type("NAME=FILE")
      .one_value();
  arguments
      .add("--type", options.types,
           "Type of the image files: png (default), exr, npy, npz; of a detector also tif and "
           "fits; may be repeated")
      .type("TYPE")
      .one_value();
  arguments.flag(
      "--labels", options.labels,
      "Write labels beside the images: masks, boxes, poses and keypoints; as [labels] in "
      "the scenario, which chooses parts and flow (docs/labels.md)");
  arguments.flag("--resume", options.resume,
                 "Go on in a folder of the same run: complete frames are kept");
  declare(arguments, options.album);
  for (const SettingId id : workspace::kCommandOrder)
    if (!is_of_frames(id)) declare(arguments, options.view, id);
  arguments.add("--gl", options.gl, "OpenGL context: auto (default), egl or osmesa")
      .one_of({"auto", "egl", "osmesa"})
      .type("KIND");
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

// Run into a folder.
class SequenceRun {
 public:
  SequenceRun(const Options& options, CommandContext& context)
      : options_(options), context_(context), log_(context.log()) {}

  bool run() {
    auto opened = options_.input.open(log_);
    if (!opened) return false;
    opened_ = &*opened;
    if (!set_up()) return false;
    workspace::ViewSession session(open_, *preview::context_kind_from_name(options_.gl));
    RenderReport report(context_, true, false);
    const workspace::RunListener listener = report.listener();
    const workspace::View any(opened_->scenario.settings);
    if (!workspace::check(any, log_)) return false;
    const world::World* world = session.world(any, listener, log_, context_.job());
    if (world == nullptr || log_.has_errors()) return false;
    // once, before the folder is begun
    const auto& settings_file = opened_->scenario.files.front();
    if (!workspace::lamps_of(any.settings, *world,
                             options_.view.lamps.empty() ? settings_file : std::string(), log_))
      return false;
    RunInstruments instruments(opened_->scenario, context_);
    instruments_ = &instruments;
    if (!instruments.open(*world)) return false;
    RunFolder folder(options_.folder, types_, labelling_);
    folder_ = &folder;
    std::string manifest, settings;
    if (!describe(*world, session, manifest) || !describe_settings(*world, settings)) return false;
    if (!folder.take(log_) || !claim_files(options_.album, log_) ||
        !folder.begin(stems_, manifest, settings, options_.resume, log_))
      return false;
    if (!render(session, *world, listener) || !convert(*world)) {
      if ((log_.contains(Code("E0001")) || log_.contains(Code("E0103"))) && !options_.common.json)
        fmt::print(stderr, "complete frames are kept; --resume goes on\n");
      return false;
    }
    if (kept_ > 0 && !options_.common.json)
      fmt::print(stderr, "{} kept\n", counted(kept_, "frame"));
    if (renewed_ > 0 && !options_.common.json)
      fmt::print(stderr, "{} not whole: made again\n", counted(renewed_, "frame"));
    report.summary();
    return !options_.album.any() || make_album(options_.album, images_, options_.folder, context_);
  }

 private:
  // Settings and options of the command in place of the scenario's.
  bool set_up() {
    auto read = options_.read.opening(log_);
    auto typed = options_.view.settings(log_);
    if (!read || !typed) return false;
    open_ = *std::move(read);
    open_.prune = false;  // as in `render`
    if (!options_.targets.empty()) typed->targets = options_.targets;
    if (!open_.parameters.empty()) typed->define = std::exchange(open_.parameters, {});
    workspace::Settings& settings = opened_->scenario.settings;
    if (settings.camera_file && (typed->size || typed->fov || typed->ifov || typed->intrinsics ||
                                 typed->ortho || typed->distortion)) {
      log_.report(Code("E0201"), {},
                  "--size and other lenses cannot be combined with the camera_file of the scenario",
                  "--camera-file FILE replaces it");
      return false;
    }
    settings = workspace::with_defaults(*std::move(typed), settings);
    if (!settings.targets && !workspace::shows_sky(settings)) {
      log_.report_file(Code("E8013"), options_.input.file,
                       "the scenario names no model of a target",
                       "[targets] in the scenario, or --target NAME=FILE");
      return false;
    }
    if (options_.labels && !opened_->scenario.labels) opened_->scenario.labels.emplace();
    if (opened_->scenario.labels)
      labelling_ = std::make_shared<const workspace::Labelling>(*opened_->scenario.labels);
    if (!choose_types(settings)) return false;
    if (options_.album.any() && std::ranges::find(types_, "png") == types_.end()) {
      log_.report(Code("E0201"), {},
                  "--sheet and --video are made of PNG files, expected --type png");
      return false;
    }
    return check(options_.album, log_);
  }

  bool choose_types(const workspace::Settings& settings) {
    types_ = options_.types.empty() ? std::vector<std::string>{"png"} : options_.types;
    for (const std::string& type : types_) {
      const bool numbers = type == "tif" || type == "fits";
      if (!numbers && type != "png" && type != "exr" && type != "npy" && type != "npz") {
        log_.report(Code("E0201"), {},
                    "--type is " + in_quotes(type) + ", expected png, exr, npy, npz, tif or fits");
        return false;
      }
      if (numbers && !settings.detector && !settings.camera_file) {
        log_.report(Code("E0202"), {},
                    "--type " + type + " holds numbers of a detector, and the camera has none",
                    "docs/detector.md");
        return false;
      }
    }
    return true;
  }

  // Names of files: by the frame's own name where that is one, else by its number.
  std::string stem_of(const scenario::Frame& frame, std::uint64_t number) const {
    const bool plain = !frame.name.empty() && frame.name.size() <= 100 && frame.name[0] != '.' &&
                       std::ranges::all_of(frame.name, [](char c) {
                         return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                                (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
                       });
    return plain ? frame.name : fmt::format("{:06}", number);
  }

  // Makes the first frame for its mistakes, and for the rows of its image.
  bool find_shutter(const scenario::Frame& frame, std::uint64_t number, const world::World& world,
                    workspace::ViewSession& session) {
    workspace::check_stars(opened_->scenario, log_);
    auto view = workspace::view_of(opened_->scenario, frame, number, world, log_);
    if (!view) return false;
    const workspace::Settings& settings = view->settings;
    shutter_ = {settings.exposure->number.value_or(0), *settings.line_time, 1,
                static_cast<std::uint32_t>(*settings.tdi)};
    if (labelling_ != nullptr)
      view->labels = std::make_shared<const workspace::ViewLabels>(
          workspace::ViewLabels{labelling_, "", number, 0, nullptr, nullptr});
    const auto made = session.frame(*view, log_);
    if (made) shutter_.rows = made->camera().height;
    return bool(made);
  }

  // Labels that no part has, formats that cannot hold the targets.
  bool check_labels(const world::World& world) {
    if (labelling_ == nullptr) return true;
    for (const labels::FormatInfo& info : labels::formats())
      if (info.one_target && world.size() > 1 &&
          std::ranges::find(labelling_->formats, info.name) != labelling_->formats.end()) {
        log_.report_file(Code("E9003"), options_.input.file,
                         fmt::format("the format {} holds one target; the scenario has {}",
                                     in_quotes(info.name), world.size()),
                         fmt::format("after the run: panwright labels {} --format {} --target NAME",
                                     options_.folder, info.name));
        return false;
      }
    return check_formats() && bool(labels::named_things(world, labelling_->options.parts, log_));
  }

  // What the formats of labels need of a run.
  bool check_formats() {
    const auto has = [&](const char* type) {
      return std::ranges::find(types_, type) != types_.end();
    };
    const auto need = [&](std::string_view format, const char* what, const char* hint) {
      log_.report_file(Code("E9003"), options_.input.file,
                       fmt::format("the format {} has {}, which this run does not write",
                                   in_quotes(format), what),
                       fmt::format("{}; or without, after the run: panwright labels {} --format {}",
                                   hint, options_.folder, format));
    };
    const std::size_t errors = log_.errors();
    for (const labels::FormatInfo& info : labels::formats()) {
      if (std::ranges::find(labelling_->formats, info.name) == labelling_->formats.end()) continue;
      if (info.png && !has("png")) need(info.name, "PNG images", "--type png as well");
      if (info.depth && !has("npz") && !has("exr"))
        need(info.name, "depth", "--type png --type npz");
      if (info.flow && !labelling_->flow) need(info.name, "flow", "flow = true in [labels]");
    }
    return log_.errors() == errors;
  }

  // Returns true if the sources cover the exposure of a frame.
  bool is_covered(double time) const {
    if (shutter_.instant()) return true;
    for (const double at : {time + shutter_.begin(), time + shutter_.end()}) {
      DiagnosticLog apart = log_.apart();
      if (workspace::frame_at(opened_->scenario, at, apart)) continue;
      for (const Diagnostic& each : apart.entries()) {
        const FileId file = each.where.file;
        log_.report_file(
            each.code, file == kNoFile ? "" : apart.sources().file(file).name,
            fmt::format("the exposure of the frame at {:.9g} s: {}", time, each.message),
            each.hint);
      }
      return false;
    }
    return true;
  }

  // All frames, a line each, before any is drawn: errors of the scenario come first.
  bool describe(const world::World& world, workspace::ViewSession& session, std::string& manifest) {
    for (std::size_t k = 0; k < opened_->times.size(); ++k) {
      if (k % kChunk == 0) context_.job().poll();
      const std::uint64_t number = opened_->first + k;
      const auto frame = workspace::frame_at(opened_->scenario, opened_->times[k], log_);
      if (!frame) return false;
      const std::string stem = stem_of(*frame, number);
      if (!stems_.insert(stem).second) {
        log_.report_file(Code("E8013"), options_.input.file,
                         fmt::format("two frames have the name {}", in_quotes(stem)));
        return false;
      }
      if (options_.album.any())
        images_.push_back(std::filesystem::path(options_.folder) / (stem + ".png"));
      if (k == 0 && !(find_shutter(*frame, number, world, session) && check_labels(world)))
        return false;
      if (!is_covered(opened_->times[k]) || !instruments_->is_covered(opened_->times[k]))
        return false;
      Json line = frame_json(*frame, number);
      line["outputs"] = folder_->outputs_of(stem);
      if (instruments_->any()) {
        line["measured"] = instruments_->outputs_of(stem);
        folder_->add_files(instruments_->outputs_of(stem));
      }
      if (labelling_ != nullptr) line["labels"] = folder_->labels_of(stem);
      manifest += line.dump() + "\n";
    }
    for (const auto& instrument : opened_->scenario.instruments)
      for (const std::string& stem : stems_) {
        if (!stems_.contains(stem + "." + instrument.name)) continue;
        log_.report_file(Code("E8013"), options_.input.file,
                         fmt::format("the frame {} has the name of what {} measures of {}",
                                     in_quotes(stem + "." + instrument.name),
                                     in_quotes(instrument.name), in_quotes(stem)));
        return false;
      }
    return true;
  }

  // All else that decides the images: program, models, settings, the camera's file.
  bool describe_settings(const world::World& world, std::string& text) {
    Json out{{"program", workspace::recorded_program()}};
    for (const world::Instance& target : world.instances())
      out["targets"].push_back(
          {{"name", target.name()}, {"build_id", target.model()->build_id().hex()}});
    const workspace::Settings& settings = opened_->scenario.settings;
    for (std::size_t k = 0; k < std::size(workspace::kSettings); ++k) {
      const auto id = static_cast<SettingId>(k);
      if (id == SettingId::targets || !workspace::has_value(id, settings)) continue;
      out["settings"][std::string(workspace::info_of(id).name)] =
          workspace::setting_texts(id, settings);
    }
    if (labelling_ != nullptr) {
      Json parts = Json::array();
      for (const labels::ChosenPart& part : labelling_->options.parts)
        parts.push_back({{"label", part.label}, {"node", part.node}});
      out["labels"] = {{"parts", parts},
                       {"keypoint_slack", labelling_->options.keypoint_slack},
                       {"flow", labelling_->flow}};
      if (!labelling_->formats.empty()) out["labels"]["formats"] = labelling_->formats;
    }
    if (instruments_->any()) out["instruments"] = instruments_->settings();
    if (settings.camera_file) {
      constexpr std::uint64_t kMostBytes = 1 << 20;
      const auto camera = read_file(*settings.camera_file, kMostBytes, log_);
      if (!camera) return false;
      out["camera"] = *camera;
    }
    text = out.dump(2, ' ', true, Json::error_handler_t::replace) + "\n";
    return true;
  }

  bool add_labels(std::size_t k, const std::string& stem, const world::World& world,
                  workspace::View& view) {
    workspace::ViewLabels labels{labelling_,        stem,    opened_->first + k,
                                 opened_->times[k], nullptr, nullptr};
    const auto neighbour = [&](std::size_t other) -> std::shared_ptr<const workspace::View> {
      const auto frame = workspace::frame_at(opened_->scenario, opened_->times[other], log_);
      if (!frame) return nullptr;
      auto made =
          workspace::view_of(opened_->scenario, *frame, opened_->first + other, world, log_);
      return made ? std::make_shared<const workspace::View>(*std::move(made)) : nullptr;
    };
    if (labelling_->flow && k > 0) {
      labels.previous = neighbour(k - 1);
      if (labels.previous == nullptr) return false;
    }
    if (labelling_->flow && k + 1 < opened_->times.size()) {
      labels.next = neighbour(k + 1);
      if (labels.next == nullptr) return false;
    }
    view.labels = std::make_shared<const workspace::ViewLabels>(std::move(labels));
    return true;
  }

  bool render(workspace::ViewSession& session, const world::World& world,
              const workspace::RunListener& listener) {
    std::vector<workspace::View> views;
    const std::size_t chunk = shutter_.instant() ? kChunk : kExposedChunk;
    for (std::size_t k = 0; k < opened_->times.size(); ++k) {
      const std::uint64_t number = opened_->first + k;
      const auto frame = workspace::frame_at(opened_->scenario, opened_->times[k], log_);
      if (!frame) return false;
      const std::string stem = stem_of(*frame, number);
      const bool measured = options_.resume && instruments_->has_frame(folder_->path(), stem);
      if (!measured &&
          !instruments_->measure(session, world, opened_->times[k], number, folder_->path(), stem))
        return false;
      if (options_.resume && folder_->has_frame(stem, k > 0, k + 1 < opened_->times.size())) {
        kept_ += measured ? 1 : 0;
        renewed_ += measured ? 0 : 1;
      } else {
        if (options_.resume && folder_->has_part(stem)) ++renewed_;
        auto view = workspace::view_of(opened_->scenario, *frame, number, world, log_);
        if (!view) return false;
        std::vector<std::string> outputs = folder_->outputs_of(stem);
        for (std::string& output : outputs) output = (folder_->path() / output).string();
        view->settings.outputs = std::move(outputs);
        if (labelling_ != nullptr && !add_labels(k, stem, world, *view)) return false;
        views.push_back(*std::move(view));
      }
      const bool last = k + 1 == opened_->times.size();
      if (views.size() < chunk && !last) continue;
      if (!views.empty() && !session.run(views, listener, log_, context_.job())) return false;
      views.clear();
    }
    return true;
  }

  // Writes the labels in the formats of the scenario, each into a folder of its own.
  bool convert(const world::World& world) {
    if (labelling_ == nullptr || labelling_->formats.empty()) return true;
    labels::Conversion conversion;
    conversion.folder = conversion.output = options_.folder;
    conversion.formats = labelling_->formats;
    if (conversion.formats.size() == 1) conversion.output /= conversion.formats[0];
    conversion.again = options_.resume;
    for (const world::Instance& target : world.instances())
      conversion.models.push_back({target.name(), target.model()});
    context_.step("convert");
    const auto converted = labels::convert(conversion, log_, context_.job());
    if (!converted) return false;
    for (const auto& file : converted->files) context_.wrote(file.string());
    return true;
  }

  const Options& options_;
  CommandContext& context_;
  DiagnosticLog& log_;
  ScenarioInput::Opened* opened_ = nullptr;
  workspace::OpenOptions open_;
  std::vector<std::string> types_;
  std::shared_ptr<const workspace::Labelling> labelling_;  // null: no labels
  workspace::Shutter shutter_;
  std::set<std::string> stems_;                // of all frames' files
  std::vector<std::filesystem::path> images_;  // of the contact sheet and the video, in order
  RunFolder* folder_ = nullptr;
  RunInstruments* instruments_ = nullptr;
  std::size_t kept_ = 0;
  std::size_t renewed_ = 0;
};

int run(const Options& options, const Host& host) {
  CommandContext context("run", options.common, host);
  context.leave_out(Code("N5002"));
  SequenceRun sequence(options, context);
  sequence.run();
  return context.finish();
}

}  // namespace
}  // namespace command_run

Command run_command() {
  return command("run", "Render the frames of a scenario into a folder", command_run::declare_all,
                 command_run::run);
}

}  // namespace panwright::tools
