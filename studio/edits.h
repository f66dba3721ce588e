// Numbers of materials and foil that were changed in the window and are not saved yet.
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

// A file with materials, as it is on disk and as the window has it.
struct MaterialFile {
  std::filesystem::path path;     // absolute, without links
  std::string saved;              // on disk, when it was looked at
  std::string text;               // with all edits
  std::vector<pxn::EditableMaterial> materials;  // of `text`; sheets of foil behind them, as "foil NAME"
  std::size_t foils = 0;                         // how many of them are that
};

// One number of a material, found again in a file that somebody else has changed meanwhile.
struct Edit {
  std::filesystem::path path;
  std::string material, element, attribute;
  std::size_t index = 0;
  double value = 0;
  bool same_place(const Edit& other) const;
};

// A line of a text with what became of it.
struct ChangedLine {
  std::uint32_t number = 0;
  std::string before, after;
};

class Edits {
 public:
  // Looks at the files, those of a .pxn extension, and applies the edits to what they hold now.
  // Those that find no place any more are dropped, and said.
  void look(const std::vector<std::filesystem::path>& files);

  const std::vector<MaterialFile>& files() const { return files_; }

  // Changes a number. Changes of one number that follow each other, until close(), are undone
  // together.
  void change(const MaterialFile& file, const pxn::EditableMaterial& material,
              const pxn::EditableNumber& number, double value);
  void close() { open_ = false; }
  bool undo();  // the last one; false: there is none
  void drop() { edits_.clear(), apply(); }
  bool any() const { return !edits_.empty(); }
  std::size_t size() const { return edits_.size(); }

  // Of all files with edits.
  std::map<std::filesystem::path, std::shared_ptr<const std::string>> unsaved() const;
  std::vector<std::pair<std::filesystem::path, std::vector<ChangedLine>>> difference() const;

  // Writes the files, each whole or not at all. Edits of one that cannot be written stay.
  // Fails: E0103, for a file too that holds something else than when it was looked at.
  bool save(DiagnosticLog& log);

  const std::string& said() const { return said_; }

 private:
  void apply();
  std::vector<MaterialFile> files_;
  std::vector<Edit> edits_;
  bool open_ = false;  // the last edit goes on
  std::string said_;
};

}  // namespace panwright::studio
