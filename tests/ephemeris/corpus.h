// Public kernels beside the checkout.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "ephemeris/kernels.h"

namespace panwright::ephemeris::testing_support {

inline std::filesystem::path folder() {
  const char* given = std::getenv("PANWRIGHT_CORPUS");
  return (given != nullptr && *given != '\0' ? std::filesystem::path(given)
                                             : std::filesystem::path(PANWRIGHT_CORPUS_DIR)) /
         "spice";
}

inline std::optional<Kernels> load(const std::vector<std::string>& files) {
  std::vector<std::filesystem::path> paths;
  for (const std::string& each : files) paths.push_back(folder() / each);
  DiagnosticLog log;
  auto out = Kernels::load(paths, log);
  EXPECT_TRUE(out) << to_text(log);
  return out ? std::optional<Kernels>(*out) : std::nullopt;
}

}  // namespace panwright::ephemeris::testing_support
