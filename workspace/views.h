// Views: settings of an image with their origin, from a views file or a line of a stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "workspace/labelling.h"
#include "workspace/settings.h"

namespace panwright::workspace {

// Way of an image to who asks for it: files, or with the answer to a line of a stream.
enum class ImageReply : std::uint8_t { files, inlined, shared };

struct View {
  View() = default;
  View(Settings from) : settings(std::move(from)) {}
  Settings settings;
  bool field_of_view = false;  // intrinsics stand for one, of an image of the size
  std::string label;  // name in diagnostics, as "view 3 ('far')"; empty: options of a command
  std::string file;   // views file of origin; empty: none
  std::shared_ptr<const ViewLabels> labels;  // to write; null: none
  ImageReply reply = ImageReply::files;      // of a stream, as its member `image` says
  // Of a scenario: the settings at a time after this view's, seconds; fails as it does. Empty: at
  // no other time is anything known.
  std::function<std::optional<Settings>(double, DiagnosticLog&)> motion;
};

// Reads a views file (docs/views.md): a JSON list of objects, or, as .jsonl, one a line. Members
// are those of schemas/views.toml, with '-' or '_' between words. Missing ones are taken from
// `defaults`, as by with_defaults().
//
//   returns  one view or more, each with an output
// Fails: E0101…E0104, E0203. Reports: W1214.
Result<std::vector<View>> read_views(const std::filesystem::path& path, const Settings& defaults,
                                     DiagnosticLog& log);

// The same for a text in memory; `name` is its name in diagnostics.
Result<std::vector<View>> parse_views(std::string_view text, const std::string& name,
                                      const Settings& defaults, DiagnosticLog& log);

// Parses one view, an object, as a line of a stream. It may have `image` in place of outputs:
// "inline" or "shared".
//
//   index  its number in the stream
//   view   its readable part; name and label in any case
// False: E0203.
bool parse_view(std::string_view text, std::size_t index, const Settings& defaults, View& view,
                DiagnosticLog& log);

// Reports contradictory settings: E0201 (of a view with a label: E0203), E0202.
bool check(const View& view, DiagnosticLog& log);

// Limit of bytes in one line of a stream of views.
constexpr std::size_t kMaxViewLine = std::size_t{1} << 20;

}  // namespace panwright::workspace
