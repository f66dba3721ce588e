// Diagnostics about one XML document, with the path of the element in the model.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/diagnostic.h"
#include "pxn/text/xml.h"

namespace panwright::pxn {

// Returns "pangu_model/group[2]/mesh": names from the root, with an index (from 1) for an element
// with siblings of its name. Cost: O(depth · siblings).
std::string object_path(const xml::Document& document, std::uint32_t element);

// Reporter that composes texts only while the log keeps them: a hostile file can hold millions of
// errors.
class Reporter {
 public:
  explicit Reporter(DiagnosticLog& log) : log_(log) {}

  DiagnosticLog& log() { return log_; }

  // compose() returns the message, or a Text with a hint. The element gives the object path.
  template <class Compose>
  void report(Code code, SourceSpan where, const xml::Document& document, std::uint32_t element,
              const Compose& compose) {
    // a problem in a repeat occurs in each run
    if (repetition_ != nullptr && !seen_.insert({code, where.file, where.begin}).second) return;
    bool& full = code.severity() == Severity::error ? errors_full_ : others_full_;
    if (full) {
      log_.report(code, where, {});
      return;
    }
    const std::size_t before = log_.entries().size();
    Text text = compose();
    for (const Repetition* r = repetition_; r != nullptr; r = r->outer_)
      text.message +=
          (r == repetition_ ? ", with " : ", ") + r->variable_ + " = " + std::to_string(r->value_);
    log_.report(code, where, std::move(text.message), std::move(text.hint),
                object_path(document, element));
    full = log_.entries().size() == before;
  }

  // Scope of one run of a repeat: its problems are reported the first time only, with the value of
  // the variable.
  class Repetition {
   public:
    Repetition(Reporter& reporter, const std::string& variable, std::uint64_t value)
        : reporter_(reporter), outer_(reporter.repetition_), variable_(variable), value_(value) {
      reporter_.repetition_ = this;
    }
    ~Repetition() { reporter_.repetition_ = outer_; }
    Repetition(const Repetition&) = delete;
    Repetition& operator=(const Repetition&) = delete;

   private:
    friend class Reporter;
    Reporter& reporter_;
    const Repetition* outer_;
    const std::string& variable_;
    std::uint64_t value_;
  };

  // Scope outside of all repeats: for text read on behalf of one, but located elsewhere.
  class Elsewhere {
   public:
    explicit Elsewhere(Reporter& reporter)
        : reporter_(reporter), around_(std::exchange(reporter.repetition_, nullptr)) {}
    ~Elsewhere() { reporter_.repetition_ = around_; }
    Elsewhere(const Elsewhere&) = delete;
    Elsewhere& operator=(const Elsewhere&) = delete;

   private:
    Reporter& reporter_;
    const Repetition* around_;
  };

  struct Text {
    Text(std::string m, std::string h = {}) : message(std::move(m)), hint(std::move(h)) {}
    std::string message;
    std::string hint;
  };

 private:
  DiagnosticLog& log_;
  const Repetition* repetition_ = nullptr;
  std::set<std::tuple<Code, FileId, std::uint32_t>> seen_;  // in repeats
  bool errors_full_ = false;
  bool others_full_ = false;
};

}  // namespace panwright::pxn
