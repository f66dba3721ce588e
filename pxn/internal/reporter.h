// Diagnostics about one XML document, with the path of the element in the model.
#pragma once

#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "pxn/internal/xml.h"

namespace panwright::pxn {

// "pangu_model/group[2]/mesh": names from the root, with an index (from 1) where an element has
// siblings of its name. Cost: O(depth · siblings).
std::string object_path(const xml::Document& document, std::uint32_t element);

// A log that composes texts only while it keeps them: a hostile file can hold millions of errors.
class Reporter {
 public:
  explicit Reporter(DiagnosticLog& log) : log_(log) {}

  DiagnosticLog& log() { return log_; }

  // compose() returns the message, or a Text with a hint. The element gives the object path.
  template <class Compose>
  void report(Code code, SourceSpan where, const xml::Document& document, std::uint32_t element,
              const Compose& compose) {
    bool& full = code_info(code).severity == Severity::error ? errors_full_ : others_full_;
    if (full) {
      log_.report(code, where, {});
      return;
    }
    const std::size_t before = log_.entries().size();
    Text text = compose();
    log_.report(code, where, std::move(text.message), std::move(text.hint),
                object_path(document, element));
    full = log_.entries().size() == before;
  }

  struct Text {
    Text(std::string m, std::string h = {}) : message(std::move(m)), hint(std::move(h)) {}
    std::string message;
    std::string hint;
  };

 private:
  DiagnosticLog& log_;
  bool errors_full_ = false;
  bool others_full_ = false;
};

}  // namespace panwright::pxn
