#include "studio/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/diagnostic.h"
#include "base/file.h"
#include "studio/layers.h"

namespace panwright::studio {
namespace {

using LayoutJson = nlohmann::ordered_json;

constexpr std::uint64_t kMaxLayoutBytes = 1 << 16;
constexpr std::array<const char*, 7> kTabs = {"Camera", "Sun",       "Image", "Parts",
                                              "Joints", "Materials", "Save"};

template <class Number>
void read_member(const LayoutJson& json, const char* name, double low, double high, Number& out) {
  if (!json.contains(name) || !json[name].is_number()) return;
  const double value = json[name].get<double>();
  if (value >= low && value <= high) out = static_cast<Number>(value);
}

void read_member(const LayoutJson& json, const char* name, bool& out) {
  if (json.contains(name) && json[name].is_boolean()) out = json[name].get<bool>();
}

template <class Words>
void read_member(const LayoutJson& json, const char* name, const Words& words, std::string& out) {
  if (!json.contains(name) || !json[name].is_string()) return;
  const auto value = json[name].get<std::string>();
  if (std::find(std::begin(words), std::end(words), std::string_view(value)) != std::end(words))
    out = value;
}

}  // namespace

std::filesystem::path layout_file() {
  namespace fs = std::filesystem;
  // relative paths are ignored (XDG Base Directory Specification)
  if (const char* folder = std::getenv("XDG_STATE_HOME"); folder != nullptr && folder[0] == '/')
    return fs::path(folder) / "panwright" / "window.json";
  const char* home = std::getenv("HOME");
  std::error_code ignored;
  if (home == nullptr || home[0] != '/' || !fs::is_directory(home, ignored)) return {};
  return fs::path(home) / ".local" / "state" / "panwright" / "window.json";
}

Layout read_layout(const std::filesystem::path& file, std::string& problem) {
  Layout out;
  problem.clear();
  std::error_code ignored;
  if (file.empty() || !std::filesystem::exists(file, ignored)) return out;
  DiagnosticLog log;
  const auto bytes = read_file(file, kMaxLayoutBytes, log);
  const LayoutJson json = bytes ? LayoutJson::parse(*bytes, nullptr, false)
                                : LayoutJson(LayoutJson::value_t::discarded);
  if (!json.is_object()) {
    problem = "the saved layout of the window cannot be read; the default is used";
    return out;
  }
  read_member(json, "width", 320, 16384, out.width);
  read_member(json, "height", 240, 16384, out.height);
  read_member(json, "panel", 100, 4000, out.panel);
  read_member(json, "panel_shown", out.panel_shown);
  read_member(json, "text", kSmallestText, kLargestText, out.text);
  read_member(json, "tab", kTabs, out.tab);
  read_member(json, "layer", kLayers, out.layer);
  read_member(json, "mark_white", out.mark_white);
  read_member(json, "labels", out.labels);
  return out;
}

bool write_layout(const std::filesystem::path& file, const Layout& layout) {
  if (file.empty()) return false;
  const LayoutJson json = {{"width", layout.width},  {"height", layout.height},
                           {"panel", layout.panel},  {"panel_shown", layout.panel_shown},
                           {"text", layout.text},    {"tab", layout.tab},
                           {"layer", layout.layer},  {"mark_white", layout.mark_white},
                           {"labels", layout.labels}};
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error) return false;
  const std::string text = json.dump(2) + "\n";
  DiagnosticLog ignored;
  return write_file(file, as_bytes(text), ignored);
}

}  // namespace panwright::studio
