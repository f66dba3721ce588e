// Shared parts of the pxn tests: reading a text, and a summary of the log.
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "base/diagnostic.h"
#include "pxn/pxn.h"

namespace panwright::pxn {

struct Reading {
  DiagnosticLog log;
  Result<scene::Scene> scene = failed;

  // "line:column code message" of each entry, one a line.
  std::string summary() const {
    std::string out;
    for (const Diagnostic& entry : log.entries()) {
      if (entry.where.file != kNoFile && log.sources().file(entry.where.file).bytes) {
        const Position p = log.sources().position(entry.where.file, entry.where.begin);
        out += std::to_string(p.line) + ":" + std::to_string(p.column) + " ";
      }
      out += std::string(code_info(entry.code).name) + " " + entry.message;
      if (!entry.hint.empty()) out += " (" + entry.hint + ")";
      out += "\n";
    }
    return out;
  }
  std::multiset<std::string> codes() const {
    std::multiset<std::string> out;
    for (const Diagnostic& entry : log.entries()) out.emplace(code_info(entry.code).name);
    return out;
  }
};

// Reads files in memory; every returned scene is checked.
inline Reading read_files(const std::vector<MemoryFile>& files, const Options& options = {}) {
  Reading reading;
  reading.scene = read_memory(files, options, reading.log);
  if (reading.scene) {
    EXPECT_EQ(scene::check(*reading.scene), "");
  }
  return reading;
}

// The same for the nodes of one model: the first of them is in line 2.
inline Reading read_nodes(const std::string& nodes, const Options& options = {}) {
  return read_files({{"m.pxn", "<pangu_model ver=\"0\">\n" + nodes + "\n</pangu_model>\n"}},
                    options);
}

inline Reading read_path(const std::string& path, const Options& options = {}) {
  Reading reading;
  reading.scene = read(path, options, reading.log);
  if (reading.scene) {
    EXPECT_EQ(scene::check(*reading.scene), "");
  }
  return reading;
}

}  // namespace panwright::pxn
