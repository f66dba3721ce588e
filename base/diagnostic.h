// Diagnostics: the problem, its place and the values accepted.
#pragma once

#include <compare>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/source.h"

namespace panwright {

class FileUses;

enum class Severity { note, warning, error };

// Code of a diagnostic, as Code("E1101"): E, W or N for error, warning or note, and four digits.
// Its title and explanation stand in base/diagnostic_codes.def, so that a new code rebuilds one
// file.
class Code {
 public:
  explicit consteval Code(const char (&name)[6]) : Code(std::string_view(name, 5)) {}

  constexpr Severity severity() const { return static_cast<Severity>(2 - value_ % 3); }
  constexpr auto operator<=>(const Code&) const = default;

 private:
  friend std::optional<Code> code_from_name(std::string_view name);

  // Throws, which ends a compilation, for other names.
  explicit constexpr Code(std::string_view name) : value_(0) {
    for (const char digit : name.substr(1)) {
      if (digit < '0' || digit > '9') throw "a code has four digits";
      value_ = static_cast<std::uint16_t>(10 * value_ + (digit - '0'));
    }
    if (name[0] != 'E' && name[0] != 'W' && name[0] != 'N') throw "a code begins with E, W or N";
    value_ = static_cast<std::uint16_t>(3 * value_ + (name[0] == 'W' ? 1 : name[0] == 'N' ? 2 : 0));
  }

  std::uint16_t value_;  // 3 * digits + 0 E, 1 W, 2 N
};

struct CodeInfo {
  std::string_view name;         // "E1101"
  Severity severity;             // from the first letter of the name
  std::string_view title;        // one lower-case phrase
  std::string_view explanation;  // a paragraph: the meaning and the remedy
};

const CodeInfo& code_info(Code code);
std::optional<Code> code_from_name(std::string_view name);  // any letter case
std::span<const CodeInfo> all_codes();                      // in registry order

struct Diagnostic {
  Code code;
  SourceSpan where;     // marked by the caret
  std::string message;  // one lower-case sentence: the offending value and what is accepted
  std::string object;   // path in the model, as group[2]/mesh; may be empty
  std::string hint;     // "did you mean 'diffuse'?"; may be empty

  Severity severity() const { return code.severity(); }
};

// Collector of the problems of one run and of the source files they point into.
class DiagnosticLog {
 public:
  // Entries past the limit are counted and not kept.
  explicit DiagnosticLog(std::size_t limit = 50) : limit_(limit) {}

  SourceMap& sources() { return sources_; }
  const SourceMap& sources() const { return sources_; }

  // The files of the run, which all readers and writers with this log consult; null: not tracked.
  void set_files(std::shared_ptr<FileUses> files) { files_ = std::move(files); }
  const std::shared_ptr<FileUses>& files() const { return files_; }

  // Returns an empty log of the same run, for another thread or an attempt that may fail.
  DiagnosticLog apart() const {
    DiagnosticLog log(limit_);
    log.files_ = files_;
    return log;
  }

  // Adds a diagnostic. The severity follows from the code.
  void report(Code code, SourceSpan where, std::string message, std::string hint = {},
              std::string object = {});
  // The same for a file as a whole, or for no file when name is empty.
  void report_file(Code code, std::string_view file_name, std::string message,
                   std::string hint = {});

  const std::vector<Diagnostic>& entries() const { return entries_; }
  std::size_t errors() const { return errors_; }
  std::size_t warnings() const { return warnings_; }
  std::size_t notes() const { return notes_; }
  bool has_errors() const { return errors_ != 0; }
  std::size_t hidden() const { return errors_ + warnings_ + notes_ - entries_.size(); }
  bool contains(Code code) const;

  // Sorts the entries by file as opened, then from top to bottom; those without a place come last,
  // in the order reported.
  void sort_by_place();

 private:
  SourceMap sources_;
  std::shared_ptr<FileUses> files_;
  std::vector<Diagnostic> entries_;
  std::size_t limit_;
  std::size_t errors_ = 0;
  std::size_t warnings_ = 0;
  std::size_t notes_ = 0;
  std::size_t kept_errors_ = 0;
  std::size_t kept_others_ = 0;
};

// Returns the process exit code of a log (docs/conventions.md 18): 0 without errors; otherwise the
// first that occurs of 130 cancelled, 70 internal, 2 usage, 3 I/O, 4 damaged pan, 1 else.
int exit_code(const DiagnosticLog& log);

// Reports the exception that is being handled: E0002, E0003.
void report_exception(DiagnosticLog& log);

struct TextStyle {
  bool color = false;
  bool notes = true;
};

// Returns "error", "warning" or "note".
const char* severity_word(Severity severity);

// Returns for each entry file:line:column: severity: message [code], the source line, a caret,
// hints and the include stack, then a line with the number of entries not shown.
std::string to_text(const DiagnosticLog& log, const TextStyle& style = {});

// One JSON object: {"schema":1,"errors":n,"warnings":n,"diagnostics":[{code,severity,message,file,
// line,column,end_line,end_column,object,hint,included_from[]}…]}.
std::string to_json(const DiagnosticLog& log);

// A SARIF 2.1.0 log with one run.
std::string to_sarif(const DiagnosticLog& log);

// Returns the candidate nearest to a name by edit distance (insert, delete, replace, swap),
// ignoring letter case. At most max(1, length/3) away, the first of ties; else the only one with
// its begin, end or words.
std::optional<std::string_view> nearest_name(std::string_view name,
                                             std::span<const std::string_view> candidates);

}  // namespace panwright
