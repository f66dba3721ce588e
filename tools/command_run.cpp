#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file.h"
#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/frame_json.h"
#include "tools/render_report.h"
#include "tools/scenario_options.h"
#include "workspace/session.h"

namespace panwright::tools {

namespace command_run {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using workspace::SettingId;

// Frames rendered by one call of the session.
constexpr std::size_t kChunk = 256;
constexpr std::uint64_t kMostManifestBytes = 8ull << 30;

struct Options {
  CommonOptions common;
  ReadOptions read;
  ScenarioInput input;
  std::vector<std::string> targets;  // FILE or NAME=FILE
  ViewOptions view;
  std::string folder;
  std::vector<std::string> types;  // extensions; empty: png
  bool resume = false;
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
           "Folder of the images and of frames.jsonl, a line for each frame")
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
           "Type of the image files: png (default), exr, npy or npz; may be repeated")
      .type("TYPE")
      .one_value();
  arguments.flag("--resume", options.resume,
                 "Go on in a folder of the same run: complete frames are kept");
  for (const SettingId id : workspace::kCommandOrder)
    if (!is_of_frames(id)) declare(arguments, options.view, id);
  arguments.add("--gl", options.gl, "OpenGL context: auto (default), egl or osmesa")
      .one_of({"auto", "egl", "osmesa"})
      .type("KIND");
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

// Lock of a folder, for as long as a run writes into it.
class FolderLock {
 public:
  FolderLock() = default;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() {
    if (descriptor_ < 0) return;
    std::error_code ignored;
    fs::remove(path_, ignored);
    ::close(descriptor_);
  }

  // Fails: E0103; E8014 while another run has it.
  bool take(const fs::path& folder, DiagnosticLog& log) {
    path_ = folder / ".run.lock";
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0) {
      log.report_file(Code::E0103, path_.string(), "the file cannot be created");
      return false;
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return true;
    ::close(descriptor_);
    descriptor_ = -1;
    log.report_file(Code::E8014, folder.string(), "another run writes into this folder");
    return false;
  }

 private:
  fs::path path_;
  int descriptor_ = -1;
};

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
    const world::World* world = session.world(any, listener, log_, context_.job());
    if (world == nullptr) return false;
    std::string manifest;
    if (!describe(*world, manifest)) return false;
    std::error_code error;
    fs::create_directories(options_.folder, error);
    FolderLock lock;
    if (!lock.take(options_.folder, log_) || !begin(manifest)) return false;
    if (!render(session, *world, listener)) return false;
    if (kept_ > 0 && !options_.common.json)
      fmt::print(stderr, "{} kept\n", counted(kept_, "frame"));
    report.summary();
    return true;
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
    settings = workspace::with_defaults(*std::move(typed), settings);
    if (!settings.targets) {
      log_.report_file(Code::E8013, options_.input.file, "the scenario names no model of a target",
                       "[targets] in the scenario, or --target NAME=FILE");
      return false;
    }
    types_ = options_.types.empty() ? std::vector<std::string>{"png"} : options_.types;
    for (const std::string& type : types_)
      if (type != "png" && type != "exr" && type != "npy" && type != "npz") {
        log_.report(Code::E0201, {},
                    "--type is " + in_quotes(type) + ", expected png, exr, npy or npz");
        return false;
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

  std::vector<std::string> outputs_of(const std::string& stem) const {
    std::vector<std::string> out;
    for (const std::string& type : types_) out.push_back(stem + "." + type);
    return out;
  }

  // All frames, a line each, before any is drawn: errors of the scenario come first.
  bool describe(const world::World& world, std::string& manifest) {
    std::set<std::string> stems;
    for (std::size_t k = 0; k < opened_->times.size(); ++k) {
      if (k % kChunk == 0) context_.job().poll();
      const std::uint64_t number = opened_->first + k;
      const auto frame = workspace::frame_at(opened_->scenario, opened_->times[k], log_);
      if (!frame) return false;
      const std::string stem = stem_of(*frame, number);
      if (!stems.insert(stem).second) {
        log_.report_file(Code::E8013, options_.input.file,
                         fmt::format("two frames have the name {}", in_quotes(stem)));
        return false;
      }
      if (k == 0 && !workspace::view_of(opened_->scenario, *frame, number, world, log_))
        return false;
      Json line = frame_json(*frame, number);
      line["outputs"] = outputs_of(stem);
      manifest += line.dump() + "\n";
    }
    return true;
  }

  // Writes the manifest, or compares it with that of the run to go on with.
  bool begin(const std::string& manifest) {
    const fs::path path = fs::path(options_.folder) / "frames.jsonl";
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return write_file(path, as_bytes(manifest), log_);
    if (!options_.resume) {
      log_.report_file(Code::E8014, options_.folder, "the folder has the frames of a run",
                       "--resume goes on with it; or choose another folder");
      return false;
    }
    const auto before = read_file(path, kMostManifestBytes, log_);
    if (!before) return false;
    if (*before == manifest) return true;
    log_.report_file(Code::E8014, options_.folder,
                     "the folder has the frames of another run: frames.jsonl differs",
                     "choose another folder");
    return false;
  }

  bool render(workspace::ViewSession& session, const world::World& world,
              const workspace::RunListener& listener) {
    std::vector<workspace::View> views;
    for (std::size_t k = 0; k < opened_->times.size(); ++k) {
      const std::uint64_t number = opened_->first + k;
      const auto frame = workspace::frame_at(opened_->scenario, opened_->times[k], log_);
      if (!frame) return false;
      std::vector<std::string> outputs = outputs_of(stem_of(*frame, number));
      bool complete = options_.resume;
      for (std::string& output : outputs) {
        output = (fs::path(options_.folder) / output).string();
        std::error_code ignored;
        complete = complete && fs::exists(output, ignored);
      }
      if (complete) {
        ++kept_;
      } else {
        auto view = workspace::view_of(opened_->scenario, *frame, number, world, log_);
        if (!view) return false;
        view->settings.outputs = std::move(outputs);
        views.push_back(*std::move(view));
      }
      const bool last = k + 1 == opened_->times.size();
      if (views.size() < kChunk && !last) continue;
      if (!views.empty() && !session.run(views, listener, log_, context_.job())) return false;
      views.clear();
    }
    return true;
  }

  const Options& options_;
  CommandContext& context_;
  DiagnosticLog& log_;
  ScenarioInput::Opened* opened_ = nullptr;
  workspace::OpenOptions open_;
  std::vector<std::string> types_;
  std::size_t kept_ = 0;
};

int run(const Options& options, const Host& host) {
  CommandContext context("run", options.common, host);
  context.leave_out(Code::N5002);
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
