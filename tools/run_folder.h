// Folder of a run: the files of its frames, and what of them is there.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "workspace/labelling.h"

namespace panwright::tools {

// Removes from a folder what killed programs left of files: names as base/file.h gives them until
// they are whole, where the file system has no nameless ones.
void remove_unfinished_files(const std::filesystem::path& folder,
                             const std::set<std::string>& files);

class RunFolder {
 public:
  // types: extensions of the images. labelling: null: no labels.
  RunFolder(std::filesystem::path path, std::vector<std::string> types,
            std::shared_ptr<const workspace::Labelling> labelling);
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  ~RunFolder();

  const std::filesystem::path& path() const { return path_; }

  // Images of a frame, by the stem of its files.
  std::vector<std::string> outputs_of(const std::string& stem) const;
  // Its labels, by the file that is written last.
  std::string labels_of(const std::string& stem) const;

  // Adds files of frames beside images and labels.
  void add_files(const std::vector<std::string>& files) {
    more_.insert(more_.end(), files.begin(), files.end());
  }

  // Makes the folder, and keeps other runs out of it for the life of this object.
  //
  // Fails: E0103; E8014 while another run has it.
  bool take(DiagnosticLog& log);

  // Writes what the run is (frames.jsonl, run.json), or compares it with the run to go on with.
  // What a killed run left of unfinished files is removed.
  //
  // stems: of all frames. Fails: E0103; E8014 for files that the run would write over, for another
  // run, and without `resume` for the same one.
  bool begin(const std::set<std::string>& stems, const std::string& manifest,
             const std::string& settings, bool resume, DiagnosticLog& log) const;

  // Returns whether all files of a frame are there, and whole as far as image::is_whole() and
  // labels::has_whole_files() find.
  //
  // previous, next: there are such frames, to which it may have flow.
  bool has_frame(const std::string& stem, bool previous, bool next) const;
  // Returns whether any of its images is there.
  bool has_part(const std::string& stem) const;

 private:
  std::vector<std::string> files_of(const std::string& stem) const;
  bool refuse(const std::string& message, const std::string& hint, DiagnosticLog& log) const;
  bool is_free(const std::set<std::string>& stems, DiagnosticLog& log) const;
  void remove_unfinished(const std::set<std::string>& stems) const;

  std::filesystem::path path_;
  std::vector<std::string> types_;
  std::shared_ptr<const workspace::Labelling> labelling_;
  std::vector<std::string> more_;
  int lock_ = -1;
};

}  // namespace panwright::tools
