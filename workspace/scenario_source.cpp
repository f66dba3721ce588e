#include <cstddef>
#include <span>

#include "scenario/aem.h"
#include "scenario/fli.h"
#include "scenario/kernels.h"
#include "scenario/keyframes.h"
#include "scenario/oem.h"
#include "workspace/internal/scenario_source.h"

namespace panwright::workspace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string out = path.extension().string();
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

bool begins_with_keyword(std::string_view text, std::string_view keyword) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return first != text.npos && text.substr(first).starts_with(keyword);
}

Result<scenario::SourcePtr> read_source(const std::filesystem::path& path,
                                        const SourceOptions& options, DiagnosticLog& log) {
  const auto text = scenario::read_text(path, log);
  if (!text) return failed;
  const std::string extension = lower_extension(path);
  const std::string_view bytes = *text->bytes;
  if (extension == ".fli")
    return scenario::read_fli(*text, {options.objects, options.frame_rate, options.strict}, log);
  if (extension == ".oem" || begins_with_keyword(bytes, "CCSDS_OEM_VERS"))
    return scenario::read_oem(*text, {options.target, options.strict}, log);
  if (extension == ".aem" || begins_with_keyword(bytes, "CCSDS_AEM_VERS"))
    return scenario::read_aem(*text, {options.target, options.strict}, log);
  if (extension == ".json") return scenario::read_keyframes(*text, {options.strict}, log);
  if (extension == ".csv") {
    scenario::CsvOptions csv = options.csv;
    csv.strict = options.strict;
    return scenario::read_csv(*text, csv, log);
  }
  if (ephemeris::is_kernel(std::as_bytes(std::span(bytes))))
    log.report_file(Code("E0202"), path.string(), "a SPICE kernel, which does not say whose it is",
                    "[[source]] with kernels and body in a scenario: docs/ephemerides.md");
  else
    log.report_file(
        Code("E0202"), path.string(),
        "not a trajectory, expected .csv, .fli, .json (keyframes), or a message of CCSDS",
        "docs/scenarios.md");
  return failed;
}

}  // namespace panwright::workspace
