// Unsaved changes of the numbers of materials and foil.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "pxn/edit.h"

namespace panwright::studio {

// Text of a file with materials, on disk and edited.
struct MaterialFile {
  std::filesystem::path path;                    // absolute, without links
  std::string saved;                             // on disk, at the last update
  std::string text;                              // with all edits
  std::vector<pxn::EditableMaterial> materials;  // of `text`, then sheets of foil, as "foil NAME"
  std::size_t foils = 0;                         // number of sheets of foil
};

// New value of one number, found again by its names where the file has changed.
struct Edit {
  std::filesystem::path path;
  std::string material, element, attribute;
  std::size_t index = 0;
  double value = 0;
  bool same_place(const Edit& other) const;
};

// Line before and after the edits.
struct ChangedLine {
  std::uint32_t number = 0;
  std::string before, after;
};

class Edits {
 public:
  // Reads the .pxn files again and applies the edits. Edits whose number no longer exists are
  // dropped; see message().
  void update(const std::vector<std::filesystem::path>& files);

  const std::vector<MaterialFile>& files() const { return files_; }

  // Changes a number. Successive changes of one number, until close(), are one step of undo().
  void change(const MaterialFile& file, const pxn::EditableMaterial& material,
              const pxn::EditableNumber& number, double value);
  void close() { open_ = false; }
  bool undo();  // false: no edit
  void discard() { edits_.clear(), apply(); }
  bool any() const { return !edits_.empty(); }
  std::size_t size() const { return edits_.size(); }

  // Files with edits: their texts, their changed lines.
  std::map<std::filesystem::path, std::shared_ptr<const std::string>> unsaved() const;
  std::vector<std::pair<std::filesystem::path, std::vector<ChangedLine>>> difference() const;

  // Writes each file completely or not at all. Edits of a file that cannot be written are kept.
  //
  // Fails: E0103, also where a file has changed since the last update.
  bool save(DiagnosticLog& log);

  const std::string& message() const { return message_; }  // about dropped edits

 private:
  void apply();
  std::vector<MaterialFile> files_;
  std::vector<Edit> edits_;
  bool open_ = false;  // the last edit may be continued
  std::string message_;
};

}  // namespace panwright::studio
