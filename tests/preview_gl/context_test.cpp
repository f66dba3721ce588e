#include "preview/context.h"

#include <glad/gl.h>
#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace panwright::preview::context_test {
namespace {

std::unique_ptr<Context> create(ContextKind kind) {
  DiagnosticLog log;
  auto context = Context::create(kind, log);
  EXPECT_FALSE(log.has_errors()) << to_text(log);
  return context ? std::move(*context) : nullptr;
}

// clears a float texture to a value through the context and reads it back
float cleared_to(const Context& context, float value) {
  const GladGLContext& gl = context.gl();
  GLuint texture = 0;
  GLuint framebuffer = 0;
  gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
  gl.TextureStorage2D(texture, 1, GL_R32F, 4, 4);
  gl.CreateFramebuffers(1, &framebuffer);
  gl.NamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, texture, 0);
  const std::array<float, 4> color{value, 0, 0, 0};
  gl.ClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, color.data());
  std::array<float, 16> texels{};
  gl.GetTextureImage(texture, 0, GL_RED, GL_FLOAT, sizeof texels, texels.data());
  gl.DeleteFramebuffers(1, &framebuffer);
  gl.DeleteTextures(1, &texture);
  return texels[5];
}

TEST(Context, NamesOfKinds) {
  EXPECT_EQ(context_kind_from_name("auto"), ContextKind::automatic);
  EXPECT_EQ(context_kind_from_name("egl"), ContextKind::egl);
  EXPECT_EQ(context_kind_from_name("osmesa"), ContextKind::osmesa);
  EXPECT_EQ(context_kind_from_name("glx"), std::nullopt);
}

TEST(Context, EachKindIsCore45AndDraws) {
  for (const ContextKind kind : {ContextKind::osmesa, ContextKind::egl}) {
    const auto context = create(kind);
    ASSERT_TRUE(context);
    EXPECT_EQ(context->kind(), kind);
    EXPECT_TRUE(context->gl().VERSION_4_5);
    GLint profile = 0;
    context->gl().GetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    EXPECT_EQ(profile, GL_CONTEXT_CORE_PROFILE_BIT);
    EXPECT_GE(context->limits().framebuffer_side, 16384u);
    EXPECT_EQ(cleared_to(*context, 0.1f), 0.1f);
    EXPECT_EQ(context->gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
  }
}

// The automatic kind is hardware, or says in a note why it is not.
TEST(Context, AutomaticSaysWhyItFallsBack) {
  DiagnosticLog log;
  auto context = Context::create(ContextKind::automatic, log);
  ASSERT_TRUE(context);
  EXPECT_NE((*context)->is_hardware(), log.contains(Code("N5002")));
  if (log.contains(Code("N5002"))) {
    EXPECT_NE(log.entries()[0].message.find("because no EGL device is hardware"),
              std::string::npos);
  }
}

TEST(Context, TwoInOneProcessDoNotDisturbEachOther) {
  const auto a = create(ContextKind::osmesa);
  const auto b = create(ContextKind::egl);
  const auto c = create(ContextKind::osmesa);
  ASSERT_TRUE(a && b && c);
  for (int i = 0; i < 50; ++i)
    for (const auto* context : {&a, &b, &c}) {
      ASSERT_TRUE((*context)->make_current());
      const float value = static_cast<float>(i) + 0.25f;
      ASSERT_EQ(cleared_to(**context, value), value);
    }
}

TEST(Context, TwoThreads) {
  const auto work = [](ContextKind kind, bool* good) {
    DiagnosticLog log;
    auto context = Context::create(kind, log);
    *good = context.ok();
    for (int i = 0; *good && i < 100; ++i)
      *good = cleared_to(**context, static_cast<float>(i)) == static_cast<float>(i);
  };
  bool good_a = false;
  bool good_b = false;
  std::thread a(work, ContextKind::osmesa, &good_a);
  std::thread b(work, ContextKind::egl, &good_b);
  a.join();
  b.join();
  EXPECT_TRUE(good_a);
  EXPECT_TRUE(good_b);
}

TEST(Context, ReleasedAndMadeCurrentAgain) {
  const auto context = create(ContextKind::osmesa);
  ASSERT_TRUE(context);
  context->release();
  ASSERT_TRUE(context->make_current());
  EXPECT_EQ(cleared_to(*context, 3.0f), 3.0f);
}

}  // namespace
}  // namespace panwright::preview::context_test
