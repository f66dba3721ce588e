// Shared state of reading the files of one model.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "importers/import.h"
#include "importers/internal/input_file.h"
#include "importers/vrml/internal/document.h"

namespace panwright::importers::vrml {

class ReaderContext {
 public:
  ReaderContext(Files& all_files, const Options& all_options, DiagnosticLog& to_log)
      : files(all_files),
        options(all_options),
        log(to_log),
        arena_(memory_used, options.limits.memory) {}

  Files& files;
  const Options& options;
  DiagnosticLog& log;
  Job job;                                   // of the model, from open() on
  std::uint64_t memory_used = 0;             // by documents, bytes
  std::vector<scene::Input> further_inputs;  // in order of first use, without the model itself

  // Reads the model. Reports E6101 and returns nullptr if it is no VRML.
  Document* open(const InputFile& file);

  // Returns the document of the first usable URL, read once; the fragment ("#Name") is dropped.
  // Reports E6010 at `where` and returns nullptr without any.
  //
  //   where  the field with the URLs; they are relative to its file
  Document* inlined(std::span<const std::string_view> urls, SourceSpan where);

  // Reads the bytes of a texture: W6004, W6005. Its path is stored in *path.
  SharedText bytes_of(std::span<const std::string_view> urls, SourceSpan where, std::string* path);

  // Returns the first node of an instance's body, made at the first call; nullptr: no body, or one
  // that contains itself (reported). Not an instance itself: instances in instances are followed.
  // Any other node is returned as it is; nullptr stays.
  Node* actual(Node* node);

  // Frees a large list that is no longer needed, and empties the field. Small ones stay.
  //
  //   Expects: no other field shares the list, as those of instances and their bodies may.
  void release(Node& node, std::string_view field);

  const std::string& path_of(FileId file) const;

 private:
  struct Loaded {
    std::unique_ptr<Document> document;  // null: unreadable
  };
  Document* load(const InputFile& file, bool top);
  // texture: one may lie beside the model if its name leads out of the folder
  SharedText read(std::string_view url, SourceSpan where, bool texture, std::string& path,
                  std::string& problem, Code& code);
  void report_missing_part(SourceSpan where, const std::string& problem, Code code);
  Document* document_at(std::string_view url, SourceSpan where, std::string& problem, Code& code);
  Prototype* target_of(Prototype& prototype);
  void expand(Node& instance);
  Node* copied(Node* node, Node& instance, const Prototype& prototype,
               std::unordered_map<const Node*, Node*>& done);

  Arena arena_;  // of the bodies of instances
  std::map<std::string, Loaded> documents_;
  std::map<FileId, std::string> paths_;
  std::uint32_t files_read_ = 1;
  std::uint64_t copies_ = 0;
};

}  // namespace panwright::importers::vrml
