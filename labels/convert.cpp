#include "labels/convert.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>
#include <system_error>

#include "base/file.h"
#include "base/text.h"
#include "image/arrays.h"
#include "labels/internal/format.h"

namespace panwright::labels {
namespace {

namespace fs = std::filesystem;

std::vector<Format> make_table() {
  std::vector<Format> table;
  const auto add = [&](std::span<const Format> some) {
    table.insert(table.end(), some.begin(), some.end());
  };
#define PANWRIGHT_LABEL_FORMAT(name) add(name##_formats());
#include "labels/formats.def"
#undef PANWRIGHT_LABEL_FORMAT
  return table;
}

const std::vector<Format>& format_table() {
  static const std::vector<Format> table = make_table();
  return table;
}

// JSON files of frames, by name. Fails: E0101, E9003.
Result<std::vector<fs::path>> frames_in(const fs::path& folder, DiagnosticLog& log) {
  std::vector<fs::path> out;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->path().filename().string().ends_with(kLabelsExtension)) out.push_back(at->path());
  if (error) {
    log.report_file(Code("E0101"), folder.string(),
                    fmt::format("the folder cannot be read: {}", error.message()));
    return failed;
  }
  if (out.empty()) {
    log.report_file(Code("E9003"), folder.string(),
                    fmt::format("the folder has no frames with labels, NAME{}", kLabelsExtension));
    return failed;
  }
  std::ranges::sort(out);
  return out;
}

// Writes the frames of a folder in all formats.
class FolderConversion {
 public:
  FolderConversion(const Conversion& conversion, DiagnosticLog& log, const Job& job)
      : conversion_(conversion), log_(log), job_(job) {}

  Result<Converted> run() {
    const auto chosen = choose();
    if (chosen.empty()) return failed;
    const auto files = frames_in(conversion_.folder, log_);
    if (!files) return failed;
    warn_of_unfinished(files->size());
    const bool several = chosen.size() > 1;
    FrameParts parts{false, false};
    for (const Format* format : chosen) {
      const fs::path folder = several ? conversion_.output / format->info.name : conversion_.output;
      auto& output = *outputs_.emplace_back(std::make_unique<Output>(
          conversion_, folder, std::string(format->info.name), classes_, log_, job_));
      if (!output.make_folder(folder) || !is_empty(folder)) return failed;
      writers_.push_back(format->make(output));
      parts.masks |= format->parts.masks;
      parts.flow |= format->parts.flow;
    }
    Converted out;
    Phase phase(job_, "converting", files->size());
    for (const fs::path& file : *files) {
      job_.poll();
      phase.advance();
      auto frame = read_frame(file, log_, parts);
      if (!frame) continue;
      if (!take(*frame, file)) return failed;
      ++out.frames;
    }
    if (out.frames == 0) return failed;
    bool good = true;
    for (const auto& writer : writers_) good = writer->finish() && good;
    for (const auto& output : outputs_) {
      output->report_losses();
      std::ranges::move(output->tables(), std::back_inserter(out.files));
    }
    if (!good) return failed;
    return out;
  }

 private:
  std::vector<const Format*> choose() {
    std::vector<const Format*> out;
    for (const std::string& name : conversion_.formats) {
      const auto at = std::ranges::find_if(
          format_table(), [&](const Format& format) { return format.info.name == name; });
      if (at == format_table().end()) {
        std::vector<std::string_view> names;
        for (const FormatInfo& info : formats()) names.push_back(info.name);
        const auto near = nearest_name(name, names);
        std::string all;
        for (const auto& each : names) all += (all.empty() ? "" : ", ") + std::string(each);
        log_.report(Code("E0201"), {},
                    fmt::format("{} is no format of labels, expected {}", in_quotes(name), all),
                    near ? fmt::format("did you mean '{}'?", *near) : "");
        return {};
      }
      if (std::ranges::find(out, &*at) == out.end()) out.push_back(&*at);
    }
    if (out.empty()) log_.report(Code("E0201"), {}, "no format of labels is given");
    return out;
  }

  // What another conversion left would be part of the data set.
  bool is_empty(const fs::path& folder) {
    std::error_code ignored;
    if (conversion_.again || fs::is_empty(folder, ignored)) return true;
    log_.report_file(Code("E9003"), folder.string(), "the folder to write has files already",
                     "choose another folder");
    return false;
  }

  bool wanted(const Thing& thing) const {
    return conversion_.targets.empty() ||
           std::ranges::find(conversion_.targets, thing.target) != conversion_.targets.end();
  }

  bool take(FrameLabels& frame, const fs::path& file) {
    const auto refuse = [&](std::string message) {
      log_.report_file(Code("E9003"), file.string(), std::move(message));
      return false;
    };
    if (!numbers_.insert(frame.number).second)
      return refuse(fmt::format("two frames have the number {}", frame.number));
    if (numbers_.size() == 1 && !has_all_targets(frame)) return false;
    std::erase_if(frame.things, [&](const Thing& thing) { return !wanted(thing); });
    for (const Thing& thing : frame.things) {
      ThingClass found{
          thing.id, static_cast<std::uint32_t>(classes_.size()), thing.target, thing.label, {}};
      for (const Keypoint& keypoint : thing.keypoints) found.keypoints.push_back(keypoint.name);
      const auto [at, is_new] = classes_.try_emplace(thing.id, found);
      if (!is_new && (at->second.target != thing.target || at->second.label != thing.label))
        return refuse(fmt::format("id {} is {}, and {} in a frame before", thing.id,
                                  in_quotes(found.name()), in_quotes(at->second.name())));
    }
    for (const auto& writer : writers_)
      if (!writer->add(frame)) return false;
    return true;
  }

  // A run that was stopped lists frames that have no labels yet.
  void warn_of_unfinished(std::size_t found) {
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 32;
    const fs::path list = conversion_.folder / "frames.jsonl";
    std::error_code ignored;
    if (!fs::exists(list, ignored)) return;
    DiagnosticLog apart = log_.apart();
    const auto text = read_file(list, kMostBytes, apart);
    if (!text) return;
    const auto frames = static_cast<std::size_t>(std::ranges::count(*text, '\n'));
    if (frames > found)
      log_.report_file(Code("W9002"), conversion_.folder.string(),
                       fmt::format("{} of {} frames of the run have labels", found, frames),
                       "panwright run … --resume makes the others");
  }

  // All frames of a run have the same targets.
  bool has_all_targets(const FrameLabels& frame) {
    std::vector<std::string_view> names;
    for (const Thing& thing : frame.things) names.push_back(thing.target);
    for (const std::string& target : conversion_.targets) {
      if (std::ranges::find(names, target) != names.end()) continue;
      const auto near = nearest_name(target, names);
      log_.report_file(Code("E9003"), conversion_.folder.string(),
                       fmt::format("the frames have no target {}", in_quotes(target)),
                       near ? fmt::format("did you mean '{}'?", *near) : "");
      return false;
    }
    return true;
  }

  const Conversion& conversion_;
  DiagnosticLog& log_;
  const Job& job_;
  std::map<std::uint32_t, ThingClass> classes_;
  std::set<std::uint64_t> numbers_;
  std::vector<std::unique_ptr<Output>> outputs_;
  std::vector<std::unique_ptr<LabelWriter>> writers_;
};

}  // namespace

std::span<const FormatInfo> formats() {
  static const std::vector<FormatInfo> infos = [] {
    std::vector<FormatInfo> out;
    for (const Format& format : format_table()) out.push_back(format.info);
    return out;
  }();
  return infos;
}

Result<Converted> convert(const Conversion& conversion, DiagnosticLog& log, const Job& job) {
  return run_job(job, log, [&] { return FolderConversion(conversion, log, job).run(); });
}

// ---- Output

std::vector<const ThingClass*> Output::classes_by_number() const {
  std::vector<const ThingClass*> out(classes_.size());
  for (const auto& [id, each] : classes_) out[each.number] = &each;
  return out;
}

const pan::Model* Output::model(std::string_view target) const {
  for (const TargetModel& each : conversion_.models)
    if (each.target == target) return each.model.get();
  return nullptr;
}

void Output::lost(const FrameLabels& frame, std::string what) {
  constexpr std::size_t kMostKinds = 200;
  auto at = std::ranges::find(losses_, what, &Loss::what);
  if (at == losses_.end()) {
    if (losses_.size() == kMostKinds) return;
    at = losses_.insert(at, {std::move(what), frame.name, frame.name, 0});
  }
  if (at->frames == 0 || at->last != frame.name) ++at->frames;
  at->last = frame.name;
}

void Output::report_losses() {
  for (const Loss& loss : losses_) {
    std::string frames;
    if (!loss.first.empty()) frames = fmt::format("frame {}", loss.first);
    if (loss.frames > 1) frames += fmt::format(" and {} more", loss.frames - 1);
    log_.report_file(
        Code("W9002"), {},
        fmt::format("{}: {}{}{}", format_, frames, frames.empty() ? "" : ": ", loss.what));
  }
  losses_.clear();
}

const Thing* Output::only_target(const FrameLabels& frame, bool& good) {
  const Thing* found = nullptr;
  for (const Thing& thing : frame.things) {
    if (!thing.label.empty()) continue;
    if (found != nullptr) {
      good = impossible(frame,
                        fmt::format("it has several targets, {} and {}; the format holds one",
                                    in_quotes(found->target), in_quotes(thing.target)),
                        fmt::format("--target {}", found->target));
      return nullptr;
    }
    found = &thing;
  }
  if (found == nullptr) lost(frame, "it has no target, and is left out");
  return found;
}

bool Output::impossible(const FrameLabels& frame, std::string why, std::string hint) {
  log_.report_file(Code("E9003"), conversion_.folder.string(),
                   fmt::format("{}: frame {}: {}", format_, frame.name, why), std::move(hint));
  return false;
}

bool Output::make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (fs::is_directory(folder, error)) return true;
  log_.report_file(Code("E0103"), folder.string(), "the folder cannot be made");
  return false;
}

bool Output::write(const fs::path& file, std::string_view bytes) {
  const fs::path path = folder_ / file;
  if (!make_folder(path.parent_path())) return false;
  // note: not synced: all of it can be made again
  auto out = AtomicFile::create(path, log_);
  return out && out->write(as_bytes(bytes), log_) && out->publish(log_);
}

bool Output::write_table(const fs::path& file, std::string_view bytes) {
  if (!write_file(folder_ / file, as_bytes(bytes), log_)) return false;
  add_table(file);
  return true;
}

std::optional<std::string> Output::png_of(const FrameLabels& frame) const {
  std::error_code ignored;
  for (const std::string& name : {frame.image, frame.name + ".png"})
    if (fs::path(name).extension() == ".png" &&
        fs::is_regular_file(conversion_.folder / name, ignored))
      return name;
  return std::nullopt;
}

bool Output::place_png(const FrameLabels& frame, const fs::path& file) {
  const auto name = png_of(frame);
  if (!name) {
    lost(frame, "it has no PNG image, which is left out");
    return true;
  }
  const fs::path from = conversion_.folder / *name, to = folder_ / file;
  if (!make_folder(to.parent_path())) return false;
  std::error_code error;
  if (fs::equivalent(from, to, error)) return true;
  fs::remove(to, error);
  fs::create_hard_link(from, to, error);
  if (error) fs::copy_file(from, to, error);
  if (error)
    log_.report_file(Code("E0103"), to.string(),
                     fmt::format("the image cannot be copied: {}", error.message()));
  return !error;
}

Result<std::vector<float>> Output::depth_of(const FrameLabels& frame) {
  std::error_code ignored;
  for (const std::string& name : {frame.image, frame.name + ".npz", frame.name + ".exr"}) {
    const fs::path path = conversion_.folder / name;
    if ((path.extension() != ".npz" && path.extension() != ".exr") ||
        !fs::is_regular_file(path, ignored))
      continue;
    auto depth = image::read_depth(path, frame.camera.width, frame.camera.height, log_);
    if (!depth || !depth->empty()) return depth;
  }
  return std::vector<float>{};
}

}  // namespace panwright::labels
