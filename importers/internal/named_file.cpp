#include "importers/internal/named_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "base/text.h"

namespace panwright::importers {

namespace {

namespace fs = std::filesystem;
using Outcome = Files::Outcome;

constexpr std::string_view kOutOfFolder = "leads out of the model's folder";
constexpr int kMostAbove = 16;  // folders above the model in which packages are looked for

// The rest of package://NAME/… after the scheme; empty: another name.
std::string_view in_package(std::string_view name) {
  for (const std::string_view scheme : {"package://", "model://"})
    if (name.starts_with(scheme)) return name.substr(scheme.size());
  return {};
}

bool is_remote(std::string_view name) {
  return !name.starts_with("file:") &&
         (name.find("://") != name.npos || name.starts_with("urn:") || name.starts_with("data:"));
}

class Search {
 public:
  Search(Files& files, const FileName& name) : files_(files), name_(name) {}

  NamedFile run() {
    const std::string path = path_in(name_.text, name_.percent_encoded);
    const std::string_view package = in_package(name_.text);
    if (!package.empty())
      add_package(package);
    else
      add(name_.text, name_.percent_encoded);
    if (look(places_)) return std::move(out_);
    // a program that encodes names, or does not
    if (package.empty() && name_.text.find('%') != name_.text.npos) {
      add(name_.text, !name_.percent_encoded);
      if (look(places_)) {
        out_.deviation = fmt::format("{} is read as {}", in_quotes(name_.text),
                                     in_quotes(files_.display_name(out_.path)));
        return std::move(out_);
      }
    }
    const bool remote = package.empty() && is_remote(name_.text);
    const bool leads_out = seen_ == Outcome::outside && !remote && package.empty();
    // a folder of the machine that wrote it: the file may have come along without it
    if (leads_out && (!name_.part || is_absolute(path)) && beside(path)) return std::move(out_);
    out_.outcome = seen_;
    out_.path = !first_.empty() || places_.empty() ? first_ : places_.front();
    if (!out_.path.empty()) files_.declare(out_.path);
    out_.outside = leads_out || !package.empty();
    out_.problem = problem(remote, !package.empty());
    return std::move(out_);
  }

 private:
  void add(std::string_view text, bool encoded) {
    std::vector<std::string> places;
    const std::string path = path_in(text, encoded);
    if (path.find('\0') != path.npos) return;
    if (path.starts_with('/')) {
      if (auto inside = files_.relative(path)) places.push_back(std::move(*inside));
    } else {
      for (const std::string& base : name_.including)
        if (auto place = resolved(base, text, encoded)) places.push_back(std::move(*place));
    }
    for (std::string& place : places)
      if (std::ranges::find(places_, place) == places_.end()) places_.push_back(std::move(place));
  }

  void add_package(std::string_view rest) {
    const std::size_t slash = rest.find('/');
    const auto inside = slash == rest.npos ? std::string_view() : rest.substr(slash + 1);
    for (const std::string& base : name_.including) {
      fs::path above;
      for (int k = 0; k < kMostAbove; ++k, above /= "..") {
        const std::string at = (fs::path(base).parent_path() / above / "model").generic_string();
        for (const std::string_view part : {rest, inside})
          if (const auto place = resolved(at, part, false)) places_.push_back(*place);
      }
    }
  }

  // Exact names come first: a file is never taken for another one that is there.
  bool look(const std::vector<std::string>& places) {
    for (const std::string& place : places) {
      const Outcome outcome = files_.read(place, out_.bytes);
      if (outcome == Outcome::found) return found(place);
      const bool told =
          outcome != Outcome::outside && (outcome != Outcome::missing || seen_ == Outcome::outside);
      if (!told) continue;
      seen_ = outcome;
      first_ = place;
    }
    if (seen_ != Outcome::missing) return false;
    for (const std::string& place : places) {
      const auto other = files_.same_but_for_case(place);
      if (!other || files_.read(*other, out_.bytes) != Outcome::found) continue;
      out_.deviation =
          fmt::format("{} is read as {}: case matters", in_quotes(name_.text), in_quotes(*other));
      return found(*other);
    }
    return false;
  }

  bool found(const std::string& place) {
    out_.outcome = Outcome::found;
    out_.path = place;
    return true;
  }

  bool beside(const std::string& path) {
    const std::string last = path.substr(path.find_last_of("/:") + 1);
    std::vector<std::string> places;
    for (const std::string& base : name_.including)
      if (auto place = resolved(base, last, false)) places.push_back(std::move(*place));
    seen_ = Outcome::outside;
    const bool any = look(places);
    if (any)
      out_.deviation = fmt::format("{} {}; {} is taken for it", in_quotes(name_.text), kOutOfFolder,
                                   in_quotes(files_.display_name(out_.path)));
    seen_ = Outcome::outside;
    return any;
  }

  std::string problem(bool remote, bool package) const {
    if (name_.text.empty()) return "an empty name";
    if (name_.text.find('\0') != name_.text.npos)
      return fmt::format("{} is not the name of a file", in_quotes(name_.text));
    if (remote) return fmt::format("{} is not a file of the model", in_quotes(name_.text));
    if (package && seen_ != Outcome::too_large && seen_ != Outcome::unreadable)
      return fmt::format("{} is not a file in the folder of the model", in_quotes(name_.text));
    if (seen_ == Outcome::outside) return fmt::format("{} {}", in_quotes(name_.text), kOutOfFolder);
    return fmt::format("{} {}", in_quotes(files_.display_name(out_.path)),
                       seen_ == Outcome::missing     ? "does not exist"
                       : seen_ == Outcome::too_large ? "is larger than the limit"
                                                     : "cannot be read");
  }

  Files& files_;
  const FileName& name_;
  std::vector<std::string> places_;  // where it is looked for, best first
  Outcome seen_ = Outcome::outside;
  std::string first_;  // the place of that
  NamedFile out_;
};

}  // namespace

NamedFile find_file(Files& files, const FileName& name) { return Search(files, name).run(); }

}  // namespace panwright::importers
