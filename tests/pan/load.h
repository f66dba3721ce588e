// Models of bytes that must be valid.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "pan/model.h"

namespace panwright::pan {

inline Model load(const std::vector<std::byte>& bytes) {
  DiagnosticLog log;
  auto model = Model::from_bytes(bytes, "x.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return *std::move(model);
}

}  // namespace panwright::pan
