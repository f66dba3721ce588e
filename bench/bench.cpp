#include "bench/bench.h"

#include <unistd.h>

#include <algorithm>
#include <system_error>

namespace panwright::bench {

namespace {

std::vector<Case>& registry() {
  static std::vector<Case> list;
  return list;
}

}  // namespace

Context::Context(bool quick, std::filesystem::path program_folder)
    : quick_(quick), programs_(std::move(program_folder)) {
  std::string pattern =
      (std::filesystem::temp_directory_path() / "panwright-bench-XXXXXX").string();
  if (mkdtemp(pattern.data()) != nullptr) scratch_ = pattern;
}

Context::~Context() {
  std::error_code ignored;
  if (!scratch_.empty()) std::filesystem::remove_all(scratch_, ignored);
}

std::filesystem::path Context::program(std::string_view name) const {
  const std::filesystem::path path = programs_ / name;
  std::error_code none;
  return std::filesystem::exists(path, none) ? path : std::filesystem::path();
}

std::filesystem::path Context::source(std::string_view path) const {
  const std::filesystem::path full = std::filesystem::path(PANWRIGHT_SOURCE_DIR) / path;
  std::error_code none;
  return std::filesystem::exists(full, none) ? full : std::filesystem::path();
}

void Context::add(Row row) { rows_.push_back(std::move(row)); }
void Context::note(std::string text) { notes_.push_back(std::move(text)); }

bool add_case(Case one) {
  std::vector<Case>& list = registry();
  const auto place = std::lower_bound(list.begin(), list.end(), one,
                                      [](const Case& a, const Case& b) { return a.name < b.name; });
  list.insert(place, std::move(one));
  return true;
}

const std::vector<Case>& cases() { return registry(); }

}  // namespace panwright::bench
