// Folder of a data set: its table, what the rows are drawn with, and the frames that are there.
//
//   set.json          program, targets, settings of every frame
//   frames.jsonl      the table: a view for each frame, on a line of its own
//   frames/           NAME.png …, labels, and NAME.frame.json, written last: the row, its hash and
//                     those of the files
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "tools/run_folder.h"
#include "workspace/dataset.h"

namespace panwright::tools {

inline constexpr std::string_view kFrameExtension = ".frame.json";

// Settings that the frames of a set have in common.
struct DatasetSettings {
  std::string program;
  std::string plan;    // its file's name
  std::string folder;  // of the plan, from that of the set
  std::uint64_t seed = 0;
  std::vector<std::pair<std::string, std::string>> targets;    // name, file
  std::vector<std::pair<std::string, std::string>> build_ids;  // of these, as of the first frame
  std::string view;                                            // JSON
  std::string camera;                                          // text of its camera file; or empty
  std::vector<std::string> types;
  std::shared_ptr<const workspace::Labelling> labels;  // null: none
  std::string labels_json;
};
std::string dataset_settings_text(const DatasetSettings& settings);

enum class FrameState { missing, whole, changed, damaged };

class DatasetFolder {
 public:
  // Reads a set that was planned. Fails: E0101, E0102, E0104, E8018.
  static Result<DatasetFolder> open(const std::filesystem::path& path, DiagnosticLog& log);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path frames_path() const { return path_ / "frames"; }
  const DatasetSettings& settings() const { return settings_; }
  const std::vector<std::string>& rows() const { return rows_; }
  const std::string& name(std::size_t k) const { return names_[k]; }

  // Files of a frame, without the last one.
  std::vector<std::string> images_of(std::size_t k) const { return files_->outputs_of(names_[k]); }
  std::vector<std::string> files_of(std::size_t k) const;

  FrameState state_of(std::size_t k) const;
  // Writes the last file of a frame whose others are there. Fails: E0101, E0103.
  bool finish(std::size_t k, DiagnosticLog& log) const;
  // Files in frames/ that are of no frame, in order.
  std::vector<std::string> strangers() const;
  // Removes what killed runs left of these frames on file systems without nameless files.
  void remove_unfinished(std::size_t first, std::size_t end) const;

  // Keeps other processes from these frames for the life of this process. Fails: E8018, E0103.
  bool take(std::size_t first, std::size_t end, DiagnosticLog& log) const;

 private:
  DatasetFolder() = default;
  bool read_settings(DiagnosticLog& log);
  bool read_rows(DiagnosticLog& log);
  std::string row_hash(std::size_t k) const;

  std::filesystem::path path_;
  DatasetSettings settings_;
  std::string settings_text_;
  std::vector<std::string> rows_, names_;
  std::shared_ptr<const RunFolder> files_;
};

}  // namespace panwright::tools
