#include "importers/step/internal/text.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <span>

#include "base/text.h"

namespace panwright::importers::step {

namespace {

constexpr std::uint32_t kMostParentheses = 200;  // of one statement
constexpr std::uint32_t kNowhere = 0xffffffff;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }
bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

// One token after another; a token of one character stands for itself.
class Scanner {
 public:
  enum Kind : char { number = '0', word = 'a', string = '\'', reference = '#', end = 0, bad = '?' };

  explicit Scanner(std::string_view text) : text_(text) {}

  std::size_t at = 0;
  std::string_view token;        // the last one
  std::uint64_t referenced = 0;  // of a reference

  char next() {
    if (!skip_blanks()) return bad;
    const std::size_t begin = at;
    const char kind = at < text_.size() ? read() : char{end};
    token = text_.substr(begin, at - begin);
    return kind;
  }

  // The next line that begins an entity, or the end.
  std::size_t next_entity(std::size_t from) const {
    for (std::size_t i = text_.find("#", from); i != text_.npos; i = text_.find("#", i + 1)) {
      if (i > 0 && text_[i - 1] != '\n' && text_[i - 1] != '\r' && text_[i - 1] != ';') continue;
      std::size_t k = i + 1;
      while (k < text_.size() && is_digit(text_[k])) ++k;
      if (k == i + 1) continue;
      while (k < text_.size() && is_blank(text_[k])) ++k;
      if (k < text_.size() && text_[k] == '=') return i;
    }
    return text_.size();
  }

 private:
  // comments too; false for one that does not end
  bool skip_blanks() {
    while (at < text_.size()) {
      if (is_blank(text_[at])) {
        ++at;
      } else if (text_.substr(at, 2) == "/*") {
        if (at + 2 > closed_) closed_ = text_.find("*/", at + 2);
        if (closed_ == text_.npos) return false;
        at = closed_ + 2;
      } else {
        break;
      }
    }
    return true;
  }

  char read() {
    const char c = text_[at];
    if (c == '\'') return read_string();
    if (c == '#') return read_reference();
    if (is_letter(c) || c == '!') {
      while (++at < text_.size() &&
             (is_letter(text_[at]) || is_digit(text_[at]) || text_[at] == '-'))
        ;
      return word;
    }
    if (is_digit(c) || c == '+' || c == '-') return read_number();
    if (c == '.') {
      const std::size_t begin = ++at;
      while (at < text_.size() && (is_letter(text_[at]) || is_digit(text_[at]))) ++at;
      if (at == begin || at == text_.size() || text_[at] != '.') return bad;
      ++at;
      return number;
    }
    if (c == '"') {
      while (++at < text_.size() && (is_letter(text_[at]) || is_digit(text_[at])))
        ;
      if (at == text_.size() || text_[at] != '"') return bad;
      ++at;
      return number;
    }
    ++at;
    if (c == '$' || c == '*') return number;
    return c == '(' || c == ')' || c == ',' || c == ';' || c == '=' ? c : char{bad};
  }

  char read_string() {
    for (++at; at < text_.size(); ++at) {
      const char c = text_[at];
      if (c == '\0') return bad;
      if (c != '\'') continue;
      if (at + 1 < text_.size() && text_[at + 1] == '\'') {
        ++at;
        continue;
      }
      ++at;
      return string;
    }
    return bad;
  }

  char read_reference() {
    constexpr std::uint64_t kMost = 2147483647;  // OpenCASCADE keeps them as int
    const std::size_t begin = ++at;
    referenced = 0;
    while (at < text_.size() && is_digit(text_[at]) && referenced <= kMost)
      referenced = 10 * referenced + static_cast<std::uint64_t>(text_[at++] - '0');
    return at == begin || referenced > kMost ? bad : reference;
  }

  char read_number() {
    const auto digits = [&] {
      const std::size_t begin = at;
      while (at < text_.size() && is_digit(text_[at])) ++at;
      return at > begin;
    };
    if (!is_digit(text_[at])) ++at;
    if (!digits()) return bad;
    if (at < text_.size() && text_[at] == '.') {
      ++at;
      digits();
    }
    if (at < text_.size() && (text_[at] == 'E' || text_[at] == 'e')) {
      ++at;
      if (at < text_.size() && (text_[at] == '+' || text_[at] == '-')) ++at;
      if (!digits()) return bad;
    }
    return number;
  }

  std::string_view text_;
  std::size_t closed_ = 0;  // where the comment that was seen last ends
};

// References of all entities, one list behind the other.
struct References {
  std::vector<std::uint64_t> numbers;
  std::vector<std::uint64_t> first;  // of each entity in the order of the file, and the end
};

class Checker {
 public:
  Checker(std::string_view bytes, FileId file, std::uint32_t max_depth, DiagnosticLog& log,
          std::span<const std::uint64_t> without)
      : bytes_(bytes), scanner_(bytes), max_depth_(max_depth), log_(log), without_(without) {
    out_.file = file;
  }

  Text run() {
    if (!header()) return std::move(out_);
    while (section()) {
    }
    if (!ended_) {
      report(Code("E6601"), bytes_.size(), bytes_.size(),
             "the file ends before its end is written");
      repair();
      out_.repaired += in_data_ ? "\nENDSEC;\nEND-ISO-10303-21;\n" : "\nEND-ISO-10303-21;\n";
    }
    for (const auto& [begin, end] : other_files_) {
      repair();
      blank(begin, end);
    }
    if (!other_files_.empty())
      report(Code("W6004"), other_files_[0].first, other_files_[0].second,
             fmt::format("parts of it lie in other files ({}), which are not read",
                         other_files_.size()));
    if (out_.entities.empty()) {
      if (!log_.contains(Code("E6601"))) report(Code("E6601"), 0, 0, "it has no entity");
      return std::move(out_);
    }
    sort();
    find_targets();
    out_.usable = nested();
    if (out_.usable) leave_out_broken();
    return std::move(out_);
  }

 private:
  void report(Code code, std::size_t begin, std::size_t end, std::string message,
              std::string hint = {}) {
    log_.report(code,
                {out_.file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)},
                std::move(message), std::move(hint));
  }

  void repair() {
    if (out_.repaired.empty()) out_.repaired = bytes_;
  }

  void blank(std::size_t begin, std::size_t end) {
    std::fill(out_.repaired.begin() + static_cast<std::ptrdiff_t>(begin),
              out_.repaired.begin() + static_cast<std::ptrdiff_t>(end), ' ');
  }

  bool header() {
    if (bytes_.starts_with("\xef\xbb\xbf")) {
      scanner_.at = 3;
      repair();
      blank(0, 3);
    }
    if (scanner_.next() == Scanner::word && scanner_.token == "ISO-10303-21" &&
        scanner_.next() == ';')
      return true;
    report(Code("E6601"), 0, std::min<std::size_t>(bytes_.size(), 40),
           bytes_.empty() ? "the file is empty" : "it does not begin with 'ISO-10303-21;'",
           "a STEP file is a text by ISO 10303-21");
    return false;
  }

  // One statement; false at the end.
  bool section() {
    const char kind = scanner_.next();
    const std::size_t begin = scanner_.at - scanner_.token.size();
    if (kind == Scanner::end) return false;
    if (kind == Scanner::reference && in_data_) {
      entity(begin);
      return true;
    }
    if (kind == Scanner::word) {
      const std::string_view name = scanner_.token;
      if (name == "END-ISO-10303-21") {
        ended_ = true;
        return false;
      }
      if (name == "DATA") in_data_ = true;
      if (name == "ENDSEC") in_data_ = false;
      // in the header, and DATA('part',('schema'))
      if (statement_rest(false)) return true;
    }
    broken(begin);
    return true;
  }

  void entity(std::size_t begin) {
    const std::uint64_t number = scanner_.referenced;
    const std::size_t kept = references_.numbers.size();
    const bool sound = scanner_.next() == '=' && values();
    if (!sound) {
      references_.numbers.resize(kept);
      broken(begin);
      return;
    }
    references_.first.push_back(kept);
    out_.entities.push_back(
        {number, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(scanner_.at)});
  }

  // "NAME(…);" or "(NAME(…)NAME(…));"
  bool values() {
    const char kind = scanner_.next();
    if (kind == '(') return statement_rest(true);
    if (kind != Scanner::word || bytes_.substr(scanner_.at, 1) == ";") return false;
    const std::string_view name = scanner_.token;
    const bool other_file = name == "APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT" ||
                            name == "APPLIED_DOCUMENT_REFERENCE";
    const std::size_t begin = scanner_.at - name.size();
    if (!statement_rest(false)) return false;
    if (other_file) {
      // from the number on
      const std::size_t from = bytes_.rfind('#', begin);
      other_files_.emplace_back(from, scanner_.at);
    }
    return true;
  }

  // What follows a name, or the "(" of a list of names, up to ";".
  bool statement_rest(bool in_list) {
    std::uint32_t depth = in_list ? 1 : 0;
    // whether a value may come now, or must not
    bool value = in_list;
    bool after_comma = false;
    for (;;) {
      const char kind = scanner_.next();
      const bool names = in_list && depth == 1;  // nothing else may stand there
      switch (kind) {
        case ';':
          return depth == 0;
        case '(':
          if (depth > 0 ? !value || names : in_list) return false;
          if (++depth > kMostParentheses) return false;
          value = true;
          after_comma = false;
          break;
        case ')':
          if (depth == 0 || after_comma) return false;
          --depth;
          // names of a list follow each other without commas
          value = in_list && depth == 1;
          if (depth == 0 && !in_list && scanner_.next() != ';') return false;
          if (depth == 0 && !in_list) return true;
          break;
        case ',':
          if (depth == 0 || value || names) return false;
          value = true;
          after_comma = true;
          break;
        case Scanner::reference:
          references_.numbers.push_back(scanner_.referenced);
          [[fallthrough]];
        case Scanner::number:
        case Scanner::string:
          if (depth == 0 || !value || names) return false;
          value = false;
          after_comma = false;
          break;
        case Scanner::word: {
          if (depth == 0 || !value || scanner_.next() != '(') return false;
          if (++depth > kMostParentheses) return false;
          value = true;
          after_comma = false;
          break;
        }
        default:
          return false;
      }
    }
  }

  // A statement that cannot be read: what follows is read from the next entity on.
  void broken(std::size_t begin) {
    const std::size_t failed_at = std::min(scanner_.at, bytes_.size());
    const std::size_t from = scanner_.next_entity(begin + 1);
    // behind the last entity only the end may follow
    if (section_end_ <= begin) section_end_ = bytes_.find("ENDSEC", begin + 1);
    const std::size_t end = std::min({from, section_end_, bytes_.size()});
    report(Code("E6601"), begin, std::min(end, begin + 60),
           fmt::format("this statement cannot be read (at {}); it is left out",
                       in_quotes(bytes_.substr(failed_at > 0 ? failed_at - 1 : 0, 12))));
    repair();
    blank(begin, end);
    scanner_.at = end;
  }

  // By number. A number that stands twice keeps its first entity.
  void sort() {
    references_.first.push_back(references_.numbers.size());
    const std::size_t count = out_.entities.size();
    std::vector<std::uint32_t> order(count);
    for (std::size_t i = 0; i < count; ++i) order[i] = static_cast<std::uint32_t>(i);
    const auto& all = out_.entities;
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return all[a].number < all[b].number;
    });
    std::vector<Entity> entities;
    entities.reserve(count);
    from_.reserve(count);
    for (const std::uint32_t i : order) {
      if (!entities.empty() && entities.back().number == all[i].number) {
        report(Code("E6601"), all[i].begin, std::min(all[i].end, all[i].begin + 60),
               fmt::format("#{} is repeated; the first is used", all[i].number));
        repair();
        blank(all[i].begin, all[i].end);
        continue;
      }
      entities.push_back(all[i]);
      from_.push_back(i);
    }
    out_.entities = std::move(entities);
  }

  std::uint32_t index_of(std::uint64_t number) const {
    const auto it =
        std::lower_bound(out_.entities.begin(), out_.entities.end(), number,
                         [](const Entity& entity, std::uint64_t n) { return entity.number < n; });
    if (it == out_.entities.end() || it->number != number) return kNowhere;
    return static_cast<std::uint32_t>(it - out_.entities.begin());
  }

  // Whether references end, and within the depth.
  bool nested() {
    const std::size_t count = out_.entities.size();
    constexpr std::uint32_t kOpen = 0xffffffff;
    std::vector<std::uint32_t> height(count, 0);  // 0: not seen
    struct Step {
      std::uint32_t entity;
      std::uint64_t next;
      std::uint32_t below;
    };
    std::vector<Step> path;
    for (std::uint32_t start = 0; start < count; ++start) {
      if (height[start] != 0) continue;
      path.push_back({start, references_.first[from_[start]], 0});
      height[start] = kOpen;
      while (!path.empty()) {
        Step& step = path.back();
        if (step.next == references_.first[from_[step.entity] + 1]) {
          const std::uint32_t own = step.below + 1;
          height[step.entity] = own;
          path.pop_back();
          if (!path.empty()) path.back().below = std::max(path.back().below, own);
          continue;
        }
        const std::uint32_t target = targets_[step.next++];
        if (target == kNowhere) continue;
        const Entity& entity = out_.entities[target];
        if (height[target] == kOpen) {
          report(Code("E6601"), entity.begin, std::min(entity.end, entity.begin + 60),
                 fmt::format("#{} contains itself", entity.number));
          return false;
        }
        if (path.size() >= max_depth_) {
          report(Code("E6002"), entity.begin, std::min(entity.end, entity.begin + 60),
                 fmt::format("the model needs more depth than the limit allows: entities within "
                             "entities to more than {} levels",
                             max_depth_));
          return false;
        }
        if (height[target] != 0) {
          step.below = std::max(step.below, height[target]);
          if (path.size() + height[target] > max_depth_) {
            report(Code("E6002"), entity.begin, std::min(entity.end, entity.begin + 60),
                   fmt::format("the model needs more depth than the limit allows: entities within "
                               "entities to more than {} levels",
                               max_depth_));
            return false;
          }
          continue;
        }
        height[target] = kOpen;
        path.push_back({target, references_.first[from_[target]], 0});
      }
    }
    return true;
  }

  void find_targets() {
    targets_.resize(references_.numbers.size());
    for (std::size_t i = 0; i < targets_.size(); ++i)
      targets_[i] = index_of(references_.numbers[i]);
  }

  // Leaves out every entity that refers to one that is not there. OpenCASCADE follows such
  // references into nothing.
  void leave_out_broken() {
    const std::size_t count = out_.entities.size();
    std::vector<std::uint32_t> waiting;
    dead_.assign(count, false);
    for (const std::uint64_t number : without_)
      if (const std::uint32_t i = index_of(number); i != kNowhere && !dead_[i]) {
        dead_[i] = true;
        waiting.push_back(i);
      }
    std::size_t missing = 0;
    std::uint32_t missing_in = 0;
    std::vector<std::uint32_t> torn;  // with references to nothing
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto [first, last] = references_of(i);
      const auto lost = std::count(first, last, kNowhere);
      if (lost == 0) continue;
      if (missing == 0) missing_in = i;
      missing += static_cast<std::size_t>(lost);
      torn.push_back(i);
    }
    if (missing > 0) {
      const Entity& entity = out_.entities[missing_in];
      report(Code("E6601"), entity.begin, std::min(entity.end, entity.begin + 60),
             fmt::format("{} to entities that do not exist, the first in #{}",
                         counted(missing, "reference"), entity.number));
    }
    if (waiting.empty() && torn.empty()) return;
    repair();
    // who refers to whom
    std::vector<std::uint64_t> first_user(count + 1, 0);
    for (const std::uint32_t target : targets_)
      if (target != kNowhere) ++first_user[target + 1];
    for (std::size_t i = 0; i < count; ++i) first_user[i + 1] += first_user[i];
    std::vector<std::uint32_t> users(first_user[count]);
    std::vector<std::uint64_t> filled(first_user.begin(), first_user.end() - 1);
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto [first, last] = references_of(i);
      for (auto it = first; it != last; ++it)
        if (*it != kNowhere) users[filled[*it]++] = i;
    }
    const auto look_at = [&](std::uint32_t i) {
      if (dead_[i] || mended(i)) return;
      dead_[i] = true;
      waiting.push_back(i);
    };
    for (const std::uint32_t i : torn) look_at(i);
    while (!waiting.empty()) {
      const std::uint32_t i = waiting.back();
      waiting.pop_back();
      blank(out_.entities[i].begin, out_.entities[i].end);
      for (std::uint64_t k = first_user[i]; k < first_user[i + 1]; ++k) look_at(users[k]);
    }
    std::erase_if(out_.entities,
                  [&](const Entity& entity) { return out_.repaired[entity.begin] == ' '; });
    out_.usable = !out_.entities.empty();
  }

  std::pair<const std::uint32_t*, const std::uint32_t*> references_of(std::uint32_t entity) const {
    return {targets_.data() + references_.first[from_[entity]],
            targets_.data() + references_.first[from_[entity] + 1]};
  }

  // Takes what is not there out of the lists of an entity that can be without it; false: it cannot.
  bool mended(std::uint32_t index) {
    const Entity& entity = out_.entities[index];
    const std::string_view statement = bytes_.substr(entity.begin, entity.end - entity.begin);
    Scanner scanner(statement);
    scanner.next();  // #1
    scanner.next();  // =
    if (scanner.next() != Scanner::word) return false;
    const std::string_view name = scanner.token;
    constexpr std::string_view kCollections[] = {"SHELL", "_SET", "REPRESENTATION", "_MODEL",
                                                 "ASSIGNMENT"};
    if (std::none_of(std::begin(kCollections), std::end(kCollections),
                     [&](std::string_view end) { return name.ends_with(end); }))
      return false;
    std::string out(statement.substr(0, scanner.at));
    int depth = 0;
    bool skip_comma = false;
    while (const char kind = scanner.next()) {
      if (kind == Scanner::bad) return false;
      if (kind == Scanner::reference) {
        const std::uint32_t target = index_of(scanner.referenced);
        if (target == kNowhere || dead_[target]) {
          if (depth < 2) return false;
          skip_comma = true;
          continue;
        }
      }
      if (skip_comma && kind == ',') {
        skip_comma = false;
        continue;
      }
      if (skip_comma && kind == ')') {
        if (out.back() == ',') out.pop_back();
        if (out.back() == '(') return false;  // nothing is left
      }
      skip_comma = false;
      depth += kind == '(' ? 1 : kind == ')' ? -1 : 0;
      out += scanner.token;
    }
    // note: never longer than it was; what follows are blanks
    blank(entity.begin, entity.end);
    out_.repaired.replace(entity.begin, std::min(out.size(), statement.size()), out);
    return true;
  }

  std::string_view bytes_;
  Scanner scanner_;
  std::uint32_t max_depth_;
  DiagnosticLog& log_;
  Text out_;
  References references_;
  std::vector<std::uint32_t> from_;     // entities by number → order of the file
  std::vector<std::uint32_t> targets_;  // of references, as indices of entities
  std::vector<bool> dead_;              // entities that are left out
  std::span<const std::uint64_t> without_;
  std::vector<std::pair<std::size_t, std::size_t>> other_files_;
  std::size_t section_end_ = 0;  // the next one when it was looked for
  bool in_data_ = false;
  bool ended_ = false;
};

}  // namespace

Text checked(std::string_view bytes, FileId file, std::uint32_t max_depth, DiagnosticLog& log,
             std::span<const std::uint64_t> without) {
  return Checker(bytes, file, max_depth, log, without).run();
}

SourceSpan place_of(const Text& text, std::uint64_t number) {
  const auto it =
      std::lower_bound(text.entities.begin(), text.entities.end(), number,
                       [](const Entity& entity, std::uint64_t n) { return entity.number < n; });
  if (number == 0 || it == text.entities.end() || it->number != number) return {};
  constexpr std::uint32_t kShown = 60;
  return {text.file, it->begin, std::min(it->end, it->begin + kShown)};
}

}  // namespace panwright::importers::step
