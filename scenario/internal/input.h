// Text of a trajectory file with its lines, words and diagnostics. Private to scenario.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "scenario/text.h"

namespace panwright::scenario {

inline bool is_blank_char(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text);
// Words between blanks, tabs and carriage returns.
void split_words(std::string_view text, std::vector<std::string_view>& words);

class Input {
 public:
  // Adds the text to the files of the log.
  Input(const Text& text, DiagnosticLog& log);
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  // Reports the number of scaled quaternions after the first.
  ~Input();

  const std::string& name() const { return name_; }
  std::string_view bytes() const { return *bytes_; }
  DiagnosticLog& log() { return log_; }

  // Gives the next line, without its end. False after the last one, and after kMostErrors errors.
  bool next_line(std::string_view& line);

  // Reports at a part of the text. error() counts; the others do not.
  void error(Code code, std::string_view at, std::string message, std::string hint = {});
  void report(Code code, std::string_view at, std::string message, std::string hint = {});
  // W8012, or E8001 where deviations are errors.
  void deviation(bool strict, std::string_view at, std::string message, std::string hint = {});
  std::size_t errors() const { return errors_; }
  bool more() const { return errors_ < kMostErrors; }
  SourceSpan span(std::string_view part) const;

  // Reports W8006, the first time.
  void report_scaled(double length, std::string_view at);

  // Parses a finite number; reports E8001 otherwise. Exponents may be D.
  std::optional<double> number(std::string_view word, std::string_view what);

 private:
  static constexpr std::size_t kMostErrors = 20;
  std::string name_;
  SharedText bytes_;
  DiagnosticLog& log_;
  FileId file_;
  std::size_t at_ = 0;
  std::size_t errors_ = 0;
  std::size_t scaled_ = 0;
};

// Returns a quaternion of unit length. Reports W8006 where it is off by more than 1e-4; fails with
// E8005 where it is not finite, or its length outside 0.5 to 2.
std::optional<Quat> unit_quaternion(const Quat& q, Input& input, std::string_view at);

}  // namespace panwright::scenario
