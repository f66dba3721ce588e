// VRML texts in memory, read for a test.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "importers/import.h"
#include "importers/vrml/internal/reader_context.h"

namespace panwright::importers::vrml {

inline const std::string kHeader97 = "#VRML V2.0 utf8\n";

// Reading of a text into a scene.
struct Reading {
  std::vector<MemoryFile> files;  // the log shows their text
  DiagnosticLog log{100000};
  std::optional<Imported> out;

  const scene::Scene& scene() const { return out->scene; }
  std::size_t count(Code code) const {
    std::size_t n = 0;
    for (const Diagnostic& entry : log.entries()) n += entry.code == code ? 1 : 0;
    return n;
  }
  // "line:column CODE" of everything but notes, in order of report
  std::vector<std::string> places() const {
    std::vector<std::string> out_list;
    for (const Diagnostic& entry : log.entries()) {
      if (entry.severity() == Severity::note) continue;
      std::string place = "-";
      if (entry.where.file != kNoFile) {
        const Position p = log.sources().position(entry.where.file, entry.where.begin);
        place = std::to_string(p.line) + ":" + std::to_string(p.column);
      }
      out_list.push_back(place + " " + std::string(code_info(entry.code).name));
    }
    return out_list;
  }
  const scene::Node* node(std::string_view name) const {
    for (const scene::Node& node : scene().nodes)
      if (node.name == name) return &node;
    return nullptr;
  }
  std::size_t index(std::string_view name) const {
    return static_cast<std::size_t>(node(name) - scene().nodes.data());
  }
};

inline std::unique_ptr<Reading> read_files(std::vector<MemoryFile> files,
                                           const Options& options = {}) {
  auto out = std::make_unique<Reading>();
  out->files = std::move(files);
  auto result = import_memory(out->files, options, out->log);
  if (result) out->out = std::move(*result);
  return out;
}

// With the header of VRML 97 in line 1: the body begins in line 2.
inline std::unique_ptr<Reading> read97(const std::string& body, const Options& options = {}) {
  return read_files({{"model.wrl", kHeader97 + body}}, options);
}

// Reading of a text into a document, for contents outside the scene.
struct Parsed {
  std::vector<MemoryFile> stored;
  std::unique_ptr<Files> files;
  Options options;
  DiagnosticLog log{100000};
  std::unique_ptr<ReaderContext> context;
  Document* document = nullptr;
  const Node& top(std::size_t i = 0) const { return *document->nodes.at(i); }
};

inline std::unique_ptr<Parsed> parsed(const std::string& text) {
  auto out = std::make_unique<Parsed>();
  out->stored.push_back({"model.wrl", text});
  out->files = files_in_memory(out->stored, 1 << 30);
  out->context = std::make_unique<ReaderContext>(*out->files, out->options, out->log);
  out->document =
      out->context->open({"model.wrl", "model.wrl", std::make_shared<const std::string>(text), {}});
  return out;
}

inline std::unique_ptr<Parsed> parsed97(const std::string& body) {
  return parsed(kHeader97 + body);
}

}  // namespace panwright::importers::vrml
