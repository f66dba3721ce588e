// STEP texts in memory, read for a test.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "importers/import.h"
#include "importers/step/internal/read.h"

namespace panwright::importers::step {

struct Reading {
  MemoryFile file;  // the log shows its text
  DiagnosticLog log{1000};
  std::optional<Imported> out;

  const scene::Scene& scene() const { return out->scene; }
  std::size_t count(Code code) const {
    std::size_t n = 0;
    for (const Diagnostic& entry : log.entries()) n += entry.code == code ? 1 : 0;
    return n;
  }
  // of the first entry with a code; 0: none, or no place
  std::uint32_t line_of(Code code) const {
    for (const Diagnostic& entry : log.entries())
      if (entry.code == code && entry.where.file != kNoFile)
        return log.sources().position(entry.where.file, entry.where.begin).line;
    return 0;
  }
};

inline std::unique_ptr<Reading> read(std::string text, const Options& options = {}) {
  auto reading = std::make_unique<Reading>();
  reading->file = {"model.step", std::move(text)};
  auto result = import_memory({&reading->file, 1}, options, reading->log);
  if (result) reading->out = std::move(*result);
  return reading;
}

// The same in this process, without the program that reads STEP files: quick, and as brittle as
// OpenCASCADE.
inline std::unique_ptr<Reading> read_here(std::string text, const Options& options = {}) {
  auto reading = std::make_unique<Reading>();
  reading->file = {"model.step", std::move(text)};
  InputFile file;
  file.path = file.name = reading->file.path;
  file.bytes = std::make_shared<const std::string>(reading->file.bytes);
  auto result = read_in_process(file, options, reading->log);
  if (result) reading->out = std::move(*result);
  return reading;
}

}  // namespace panwright::importers::step
