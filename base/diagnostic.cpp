#include "base/diagnostic.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <exception>
#include <map>
#include <new>
#include <system_error>

namespace panwright {

namespace {

constexpr Severity severity_of(std::string_view name) {
  return name[0] == 'E' ? Severity::error : name[0] == 'W' ? Severity::warning : Severity::note;
}

constexpr std::array kCodes = {
#define PANWRIGHT_CODE(name, title, explanation) \
  CodeInfo{#name, severity_of(#name), title, explanation},
#include "base/diagnostic_codes.def"
#undef PANWRIGHT_CODE
};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Edit distance with swaps of neighbours (optimal string alignment), letter case ignored.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1]))
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

const CodeInfo& code_info(Code code) {
  static const auto table = [] {
    std::map<Code, const CodeInfo*> out;
    for (const CodeInfo& info : kCodes) out.emplace(*code_from_name(info.name), &info);
    return out;
  }();
  return *table.at(code);
}

std::span<const CodeInfo> all_codes() { return kCodes; }

std::optional<Code> code_from_name(std::string_view name) {
  std::string upper(name);
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (std::size_t i = 0; i < kCodes.size(); ++i)
    if (kCodes[i].name == upper) return Code(kCodes[i].name);
  return std::nullopt;
}

void DiagnosticLog::report(Code code, SourceSpan where, std::string message, std::string hint,
                           std::string object) {
  const Severity severity = code.severity();
  std::size_t& kept = severity == Severity::error ? kept_errors_ : kept_others_;
  ++(severity == Severity::error ? errors_ : severity == Severity::warning ? warnings_ : notes_);
  if (kept >= limit_) return;
  ++kept;
  entries_.push_back({code, where, std::move(message), std::move(object), std::move(hint)});
}

void DiagnosticLog::report_file(Code code, std::string_view file_name, std::string message,
                                std::string hint) {
  SourceSpan where;
  if (!file_name.empty()) {
    for (FileId id = 0; id < sources_.size() && where.file == kNoFile; ++id)
      if (sources_.file(id).name == file_name && !sources_.file(id).bytes) where.file = id;
    if (where.file == kNoFile)
      where.file = sources_.add({std::string(file_name), nullptr, Encoding::binary, {}});
  }
  report(code, where, std::move(message), std::move(hint));
}

bool DiagnosticLog::contains(Code code) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Diagnostic& entry) { return entry.code == code; });
}

void DiagnosticLog::sort_by_place() {
  std::stable_sort(entries_.begin(), entries_.end(), [](const Diagnostic& a, const Diagnostic& b) {
    // note: kNoFile is the largest id
    return a.where.file != b.where.file ? a.where.file < b.where.file
                                        : a.where.begin < b.where.begin;
  });
}

int exit_code(const DiagnosticLog& log) {
  bool usage = false, io = false, damaged = false, cancelled = false, internal = false;
  for (const Diagnostic& entry : log.entries()) {
    const std::string_view name = code_info(entry.code).name;
    if (entry.code == Code("E0001")) cancelled = true;
    if (entry.code == Code("E0003")) internal = true;
    if (name.starts_with("E02")) usage = true;
    if (name.starts_with("E01")) io = true;
    if (name.starts_with("E4") || name == "E9611") damaged = true;
  }
  if (!log.has_errors()) return 0;
  return cancelled ? 130 : internal ? 70 : usage ? 2 : io ? 3 : damaged ? 4 : 1;
}

void report_exception(DiagnosticLog& log) {
  const auto report_memory = [&] {
    log.report(Code("E0002"), {}, "there is not enough memory for this work");
  };
  try {
    throw;
  } catch (const std::bad_alloc&) {
    report_memory();
  } catch (const std::system_error& error) {
    // a thread without memory for its stack
    if (error.code() == std::errc::resource_unavailable_try_again ||
        error.code() == std::errc::not_enough_memory)
      return report_memory();
    log.report(Code("E0003"), {}, fmt::format("internal error: {}", error.what()));
  } catch (const std::exception& error) {
    log.report(Code("E0003"), {}, fmt::format("internal error: {}", error.what()));
  }
}

namespace {

// Whether each word of one name is a word of another, in any order.
bool has_words(std::string_view name, std::string_view words) {
  constexpr std::string_view kBetween = "_-/ ";
  const auto for_each = [&](std::string_view text, const auto& found) {
    for (std::size_t at = text.find_first_not_of(kBetween); at != text.npos;) {
      const std::size_t end = std::min(text.find_first_of(kBetween, at), text.size());
      if (found(text.substr(at, end - at))) return true;
      at = text.find_first_not_of(kBetween, end);
    }
    return false;
  };
  return !for_each(words, [&](std::string_view word) {
    return !for_each(name, [&](std::string_view other) { return other == word; });
  });
}

}  // namespace

std::optional<std::string_view> nearest_name(std::string_view name,
                                             std::span<const std::string_view> candidates) {
  constexpr std::size_t kLongest = 64;  // longer names are not typing errors
  if (name.size() > kLongest) return std::nullopt;
  const std::size_t allowed = std::max<std::size_t>(1, name.size() / 3);
  std::optional<std::string_view> best;
  std::size_t best_distance = allowed + 1;
  for (const std::string_view candidate : candidates) {
    if (candidate.size() > name.size() + allowed || name.size() > candidate.size() + allowed)
      continue;
    const std::size_t distance = edit_distance(name, candidate);
    // nothing in common: one letter for another is no typing error
    if (distance >= std::min(name.size(), candidate.size())) continue;
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  if (best) return best;
  // one that begins like it, if it is the only one: "--out" for "--output", "--sundir" for "--sun"
  constexpr std::size_t kFewest = 4;
  std::size_t alike = 0;
  for (const std::string_view candidate : candidates)
    if (std::min(candidate.size(), name.size()) >= kFewest &&
        (candidate.starts_with(name) || name.starts_with(candidate))) {
      best = candidate;
      ++alike;
    }
  if (alike > 0) return alike == 1 ? best : std::nullopt;
  // one in another folder or part: "hinge" for "wing/hinge"
  const auto last_segment = [](std::string_view path) {
    return path.substr(path.find_last_of('/') + 1);  // note: npos + 1 is 0
  };
  for (const std::string_view candidate : candidates)
    if (!last_segment(name).empty() && last_segment(candidate) == last_segment(name)) {
      best = candidate;
      ++alike;
    }
  if (alike > 0) return alike == 1 ? best : std::nullopt;
  // one that has all its words: "gold_kapton" for "mli_gold_kapton"
  for (const std::string_view candidate : candidates)
    if (name.size() >= kFewest && has_words(candidate, name)) {
      best = candidate;
      ++alike;
    }
  return alike == 1 ? best : std::nullopt;
}

}  // namespace panwright
