// Options shared by several commands.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "tools/arguments.h"
#include "workspace/open.h"
#include "workspace/settings.h"

namespace panwright::tools {

// Options of every command.
struct CommonOptions {
  bool json = false;           // one JSON object on standard output
  std::string sarif;           // also write the diagnostics here, as SARIF 2.1.0
  bool quiet = false;          // no notes
  bool timings = false;        // duration of each step, on standard error
  std::string color = "auto";  // auto, always, never
  std::uint64_t threads = 0;   // 0: all cores
};
void declare(Arguments& arguments, CommonOptions& options);

// Use of earlier results: an option of commands that compile models.
struct CacheOption {
  bool off = false;
  std::filesystem::path folder() const;  // for OpenOptions::cache
};
void declare(Arguments& arguments, CacheOption& cache);

// Declares --compress: a pan::StorageForm, "" without the option.
void declare_compress(Arguments& arguments, std::string& form);
pan::StorageForm storage_of(const std::string& form);
// Returns "lossy:14, moved by 1.2e-05 m and 0.011 deg at most"; empty: not stored as streams.
std::string storage_words(const std::string& form, const compiler::StorageReport& report);
nlohmann::ordered_json storage_json(const std::string& form, const compiler::StorageReport& report);

// Options of commands that read models.
struct ReadOptions {
  workspace::OpenOptions open;          // except the parameters
  std::vector<std::string> parameters;  // NAME=VALUE
  CacheOption cache;                    // declared separately

  // Returns all of it. Fails: E0201 for a parameter without a value, and an invalid budget.
  Result<workspace::OpenOptions> opening(DiagnosticLog& log) const;
};
void declare(Arguments& arguments, ReadOptions& options);
void declare_max_input(Arguments& arguments, std::uint64_t& bytes);
void declare_root(Arguments& arguments, std::string& root);

// Declares options of CAD files.
void declare(Arguments& arguments, workspace::CadOptions& options);

// Values of joints.
struct JointOptions {
  std::vector<std::string> values;  // "[TARGET/]JOINT=VALUE"
  std::string file;                 // JSON object of values; before `values`

  // Fails: as workspace::read_joints.
  Result<std::vector<workspace::JointText>> texts(DiagnosticLog& log) const;
};
void declare(Arguments& arguments, JointOptions& options);

// Settings of views, as typed.
struct ViewOptions {
  std::array<std::optional<std::string>, std::size(workspace::kSettings)> texts;  // by SettingId
  std::array<bool, std::size(workspace::kSettings)> flags{};
  std::vector<std::string> poses;
  std::vector<std::string> lamps;
  std::vector<std::string> planets;
  JointOptions joints;

  // Returns all of them. Fails: E0201, as workspace::read_setting(), and for two poses of one
  // target.
  Result<workspace::Settings> settings(DiagnosticLog& log) const;
  bool given(workspace::SettingId id) const {
    return texts[static_cast<std::size_t>(id)].has_value();
  }
};
// Declares one of them; with that of joints, those of JointOptions.
void declare(Arguments& arguments, ViewOptions& options, workspace::SettingId id);

}  // namespace panwright::tools
