// Format of labels, and the surroundings of its writer. Private to labels.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "labels/convert.h"
#include "labels/frame_files.h"
#include "labels/labels.h"

namespace panwright::labels {

// A target or part, over all frames.
struct ThingClass {
  std::uint32_t id = 0;      // Thing::id
  std::uint32_t number = 0;  // from 0, in order of appearance
  std::string target;
  std::string label;
  std::vector<std::string> keypoints;  // names, of the first frame with it
  bool is_target() const { return label.empty(); }
  std::string name() const { return is_target() ? target : target + "/" + label; }
};

class Output {
 public:
  Output(const Conversion& conversion, std::filesystem::path folder, std::string format,
         const std::map<std::uint32_t, ThingClass>& classes, DiagnosticLog& log, const Job& job)
      : conversion_(conversion),
        folder_(std::move(folder)),
        format_(std::move(format)),
        classes_(classes),
        log_(log),
        job_(job) {}

  const std::filesystem::path& folder() const { return folder_; }
  DiagnosticLog& log() { return log_; }
  const Job& job() const { return job_; }
  const std::map<std::uint32_t, ThingClass>& classes() const { return classes_; }
  const ThingClass& class_of(const Thing& thing) const { return classes_.at(thing.id); }
  std::vector<const ThingClass*> classes_by_number() const;
  const pan::Model* model(std::string_view target) const;  // null: not given

  // Remembers that a value was changed or left out, and how; reported once for each text. A frame
  // without a name: of all frames.
  void lost(const FrameLabels& frame, std::string what);
  void report_losses();
  // Returns the frame's only target; null: there is none, which is a loss, or there are several,
  // which is E9003 and not good.
  const Thing* only_target(const FrameLabels& frame, bool& good);
  // Reports E9003.
  bool impossible(const FrameLabels& frame, std::string why, std::string hint = {});

  // Writes a file below the folder, whose own folder is made. False: reported.
  bool write(const std::filesystem::path& file, std::string_view bytes);
  // The same for a list or table of all frames.
  bool write_table(const std::filesystem::path& file, std::string_view bytes);
  void add_table(const std::filesystem::path& file) { tables_.push_back(folder_ / file); }
  std::vector<std::filesystem::path>& tables() { return tables_; }
  bool make_folder(const std::filesystem::path& folder);

  // The PNG of a frame, relative to the folder of frames; none: there is no such file.
  std::optional<std::string> png_of(const FrameLabels& frame) const;
  std::filesystem::path path_of(const std::filesystem::path& name) const {
    return conversion_.folder / name;
  }
  // Links or copies it; a loss where there is none. False: reported.
  bool place_png(const FrameLabels& frame, const std::filesystem::path& file);
  // Depth of the frame's .npz or .exr; empty: there is none.
  Result<std::vector<float>> depth_of(const FrameLabels& frame);

 private:
  const Conversion& conversion_;
  std::filesystem::path folder_;
  std::string format_;
  const std::map<std::uint32_t, ThingClass>& classes_;
  DiagnosticLog& log_;
  const Job& job_;
  std::vector<std::filesystem::path> tables_;
  struct Loss {
    std::string what;
    std::string first, last;   // frames
    std::uint64_t frames = 0;  // number of them
  };
  std::vector<Loss> losses_;
};

class LabelWriter {
 public:
  virtual ~LabelWriter() = default;
  // Takes one frame, in their order. False: reported, and the format ends.
  virtual bool add(const FrameLabels& frame) = 0;
  virtual bool finish() = 0;
};

struct Format {
  FormatInfo info;
  FrameParts parts;  // those needed
  std::unique_ptr<LabelWriter> (*make)(Output& output);
};

template <class Writer>
std::unique_ptr<LabelWriter> make_writer(Output& output) {
  return std::make_unique<Writer>(output);
}

#define PANWRIGHT_LABEL_FORMAT(name) std::span<const Format> name##_formats();
#include "labels/formats.def"
#undef PANWRIGHT_LABEL_FORMAT

}  // namespace panwright::labels
