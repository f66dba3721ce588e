#include <map>
#include <nlohmann/json.hpp>

#include "base/diagnostic.h"

namespace panwright {

namespace {

using Json = nlohmann::ordered_json;

Json place(const SourceMap& sources, const SourceSpan& where) {
  Json out;
  out["file"] = sources.file(where.file).name;
  if (!sources.file(where.file).bytes) return out;
  const Position from = sources.position(where.file, where.begin);
  const Position to = sources.position(where.file, std::max(where.begin, where.end));
  out["line"] = from.line;
  out["column"] = from.column;
  out["end_line"] = to.line;
  out["end_column"] = to.column;
  return out;
}

Json include_stack(const SourceMap& sources, FileId file) {
  Json stack = Json::array();
  for (SourceSpan at = sources.file(file).included_at; at.file != kNoFile;
       at = sources.file(at.file).included_at)
    stack.push_back(place(sources, at));
  return stack;
}

// note: names and messages may hold any bytes that a file system allows
std::string dump(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json sarif_location(const SourceMap& sources, const SourceSpan& where) {
  const Json at = place(sources, where);
  Json physical;
  physical["artifactLocation"]["uri"] = at["file"];
  if (at.contains("line"))
    physical["region"] = {{"startLine", at["line"]},
                          {"startColumn", at["column"]},
                          {"endLine", at["end_line"]},
                          {"endColumn", at["end_column"]}};
  return {{"physicalLocation", physical}};
}

}  // namespace

std::string to_json(const DiagnosticLog& log) {
  Json out;
  out["schema"] = 1;
  out["errors"] = log.errors();
  out["warnings"] = log.warnings();
  out["notes"] = log.notes();
  out["hidden"] = log.hidden();
  out["diagnostics"] = Json::array();
  for (const Diagnostic& entry : log.entries()) {
    Json item;
    item["code"] = code_info(entry.code).name;
    item["severity"] = severity_word(entry.severity());
    item["message"] = entry.message;
    if (entry.where.file != kNoFile) {
      item.update(place(log.sources(), entry.where));
      item["included_from"] = include_stack(log.sources(), entry.where.file);
    }
    if (!entry.object.empty()) item["object"] = entry.object;
    if (!entry.hint.empty()) item["hint"] = entry.hint;
    out["diagnostics"].push_back(std::move(item));
  }
  return dump(out);
}

std::string to_sarif(const DiagnosticLog& log) {
  Json rules = Json::array();
  std::map<Code, std::size_t> rule_index;
  Json results = Json::array();
  for (const Diagnostic& entry : log.entries()) {
    const CodeInfo& about = code_info(entry.code);
    if (rule_index.emplace(entry.code, rules.size()).second) {
      rules.push_back({{"id", about.name},
                       {"shortDescription", {{"text", about.title}}},
                       {"fullDescription", {{"text", about.explanation}}}});
    }
    Json result;
    result["ruleId"] = about.name;
    result["ruleIndex"] = rule_index.at(entry.code);
    result["level"] = severity_word(entry.severity());
    result["message"]["text"] =
        entry.hint.empty() ? entry.message : entry.message + " (" + entry.hint + ")";
    if (entry.where.file != kNoFile) {
      result["locations"] = Json::array({sarif_location(log.sources(), entry.where)});
      Json related = Json::array();
      for (SourceSpan at = log.sources().file(entry.where.file).included_at; at.file != kNoFile;
           at = log.sources().file(at.file).included_at) {
        Json location = sarif_location(log.sources(), at);
        location["message"]["text"] = "included from here";
        related.push_back(std::move(location));
      }
      if (!related.empty()) result["relatedLocations"] = std::move(related);
    }
    results.push_back(std::move(result));
  }
  Json run;
  run["tool"]["driver"] = {{"name", "panwright"}, {"rules", rules}};
  run["columnKind"] = "unicodeCodePoints";
  run["results"] = results;
  Json out;
  out["$schema"] = "https://json.schemastore.org/sarif-2.1.0.json";
  out["version"] = "2.1.0";
  out["runs"] = Json::array({run});
  return dump(out);
}

}  // namespace panwright
