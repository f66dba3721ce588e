// A build without OpenGL says so.
#include <gtest/gtest.h>

#include "preview/renderer.h"

namespace panwright::preview::no_gl_test {
namespace {

TEST(WithoutOpenGL, NoContextCanBeHad) {
  for (const ContextKind kind : {ContextKind::automatic, ContextKind::egl, ContextKind::osmesa}) {
    DiagnosticLog log;
    EXPECT_FALSE(Context::create(kind, log));
    EXPECT_TRUE(log.contains(Code("E5007")));
    DiagnosticLog other;
    EXPECT_FALSE(Device::create(kind, other));
    EXPECT_TRUE(other.contains(Code("E5007")));
  }
}

}  // namespace
}  // namespace panwright::preview::no_gl_test
