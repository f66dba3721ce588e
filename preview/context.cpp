#include "preview/context.h"

#include <fmt/core.h>
#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "preview/gl/context_kinds.h"

namespace panwright::preview {
namespace {

// note: Mesa's EGL and OSMesa share one thread-local dispatch table behind both their backs, so a
// context of one kind must be released before one of the other is bound.
thread_local Context* current_context = nullptr;

GLADapiproc proc_of(void* context, const char* name) {
  return static_cast<Context*>(context)->get_proc(name);
}

bool draws_in_software(std::string_view renderer) {
  constexpr std::array<std::string_view, 4> kSoftware{"llvmpipe", "softpipe", "swrast",
                                                      "SwiftShader"};
  return std::any_of(kSoftware.begin(), kSoftware.end(), [&](std::string_view name) {
    return renderer.find(name) != std::string_view::npos;
  });
}

}  // namespace

// Counts what is made and uploaded, whoever calls.
struct ContextHooks {
  template <auto Note, class Result, class... Arguments>
  struct Hook {
    using Function = Result (*)(Arguments...);
    using Member = Function GladGLContext::*;
    template <Member member>
    static Result call(Arguments... arguments) {
      Note(current_context->counts_, arguments...);
      return (current_context->driver_.get()->*member)(arguments...);
    }
  };

  template <auto member, auto Note, class Result, class... Arguments>
  static void hook(GladGLContext& gl, Result (*GladGLContext::*)(Arguments...)) {
    gl.*member = &Hook<Note, Result, Arguments...>::template call<member>;
  }

  static void install(GladGLContext& gl) {
    constexpr auto kMade = [](ContextCounts& counts, GLsizei n, GLuint*) {
      counts.allocations += static_cast<std::uint64_t>(n);
    };
    constexpr auto kStored = [](ContextCounts& counts, auto...) { ++counts.allocations; };
    constexpr auto kBuffer = [](ContextCounts& counts, GLuint, GLsizeiptr size, const void* data,
                                auto) {
      ++counts.allocations;
      if (data) counts.uploaded_bytes += static_cast<std::uint64_t>(size);
    };
    constexpr auto kPart = [](ContextCounts& counts, GLuint, GLintptr, GLsizeiptr size,
                              const void*) {
      counts.uploaded_bytes += static_cast<std::uint64_t>(size);
    };
    // note: all textures are filled from 4 floats a texel
    constexpr auto kTexels = [](ContextCounts& counts, GLuint, GLint, GLint, GLint, GLsizei width,
                                GLsizei height, auto...) {
      counts.uploaded_bytes += std::uint64_t{16} * static_cast<std::uint64_t>(width) *
                               static_cast<std::uint64_t>(height);
    };
    using Gl = GladGLContext;
    hook<&Gl::CreateBuffers, kMade>(gl, &Gl::CreateBuffers);
    hook<&Gl::CreateFramebuffers, kMade>(gl, &Gl::CreateFramebuffers);
    hook<&Gl::CreateRenderbuffers, kMade>(gl, &Gl::CreateRenderbuffers);
    hook<&Gl::CreateVertexArrays, kMade>(gl, &Gl::CreateVertexArrays);
    hook<&Gl::CreateSamplers, kMade>(gl, &Gl::CreateSamplers);
    hook<&Gl::CreateTextures, kStored>(gl, &Gl::CreateTextures);
    hook<&Gl::CreateProgram, kStored>(gl, &Gl::CreateProgram);
    hook<&Gl::TextureStorage2D, kStored>(gl, &Gl::TextureStorage2D);
    hook<&Gl::NamedRenderbufferStorage, kStored>(gl, &Gl::NamedRenderbufferStorage);
    hook<&Gl::NamedBufferStorage, kBuffer>(gl, &Gl::NamedBufferStorage);
    hook<&Gl::NamedBufferData, kBuffer>(gl, &Gl::NamedBufferData);
    hook<&Gl::NamedBufferSubData, kPart>(gl, &Gl::NamedBufferSubData);
    hook<&Gl::TextureSubImage2D, kTexels>(gl, &Gl::TextureSubImage2D);
  }
};

namespace {

bool has_extension(const GladGLContext& gl, std::string_view name) {
  GLint count = 0;
  gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* one = gl.GetStringi(GL_EXTENSIONS, static_cast<GLuint>(i));
    if (one && name == reinterpret_cast<const char*>(one)) return true;
  }
  return false;
}

// Shaders on as many threads as the driver likes; without being asked some use none.
void compile_on_threads(const Context& context) {
  using MaxThreads = void(GLAD_API_PTR*)(GLuint);
  for (const std::string suffix : {"KHR", "ARB"})
    if (has_extension(context.gl(), "GL_" + suffix + "_parallel_shader_compile"))
      if (const auto most = reinterpret_cast<MaxThreads>(
              context.get_proc(("glMaxShaderCompilerThreads" + suffix).c_str())))
        return most(0xFFFFFFFFu);
}

}  // namespace

Context::Context()
    : gl_(std::make_unique<GladGLContext>()), driver_(std::make_unique<GladGLContext>()) {}

Context::~Context() {
  // note: derived classes release before they destroy; this catches one that never was current
  if (current_context == this) current_context = nullptr;
}

bool Context::make_current() {
  if (current_context == this) return true;
  if (current_context) current_context->release();
  // note: drivers differ in what they do with a context that another thread has
  const std::thread::id here = std::this_thread::get_id();
  std::thread::id holder{};
  if (!holder_.compare_exchange_strong(holder, here) && holder != here) return false;
  if (!bind()) {
    holder_ = std::thread::id();
    return false;
  }
  current_context = this;
  return true;
}

void Context::release() {
  if (current_context != this) return;
  unbind();
  holder_ = std::thread::id();
  current_context = nullptr;
}

std::string Context::load() {
  if (!make_current()) return "it cannot be made current";
  if (gladLoadGLContextUserPtr(gl_.get(), proc_of, this) == 0) return "its functions do not load";
  if (!gl_->VERSION_4_5) return "it is older than OpenGL 4.5";
  *driver_ = *gl_;
  ContextHooks::install(*gl_);
  const auto text = [&](GLenum name) {
    const auto* bytes = gl_->GetString(name);
    return std::string(bytes ? reinterpret_cast<const char*>(bytes) : "");
  };
  renderer_ = text(GL_RENDERER);
  version_ = text(GL_VERSION);
  hardware_ = !draws_in_software(renderer_);
  const auto integer = [&](GLenum name) {
    GLint value = 0;
    gl_->GetIntegerv(name, &value);
    return static_cast<std::uint32_t>(std::max(value, 0));
  };
  compile_on_threads(*this);
  std::array<GLint, 2> viewport{};
  gl_->GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
  limits_.texture_side = integer(GL_MAX_TEXTURE_SIZE);
  limits_.framebuffer_side =
      std::min({limits_.texture_side, integer(GL_MAX_RENDERBUFFER_SIZE),
                static_cast<std::uint32_t>(std::max(0, std::min(viewport[0], viewport[1])))});
  return {};
}

Result<std::unique_ptr<Context>> Context::create(ContextKind kind, DiagnosticLog& log) {
  if (kind == ContextKind::osmesa) {
    auto attempt = create_osmesa_context();
    if (attempt.context) return std::move(attempt.context);
    log.report_file(Code("E5001"), {}, fmt::format("no OSMesa context: {}", attempt.reason));
    return failed;
  }
  if (kind == ContextKind::egl) {
    auto attempt = create_egl_context(false);
    if (attempt.context) return std::move(attempt.context);
    log.report_file(Code("E5001"), {}, fmt::format("no EGL context: {}", attempt.reason));
    return failed;
  }
  auto hardware = create_egl_context(true);
  if (hardware.context) return std::move(hardware.context);
  auto osmesa = create_osmesa_context();
  if (osmesa.context) {
    log.report_file(Code("N5002"), {},
                    fmt::format("drawing with OSMesa ({}), because no EGL device is hardware: {}",
                                osmesa.context->renderer(), hardware.reason));
    return std::move(osmesa.context);
  }
  auto software = create_egl_context(false);
  if (software.context) {
    log.report_file(Code("N5002"), {},
                    fmt::format("drawing with EGL in software ({}), because no EGL device is "
                                "hardware: {}; and no OSMesa: {}",
                                software.context->renderer(), hardware.reason, osmesa.reason));
    return std::move(software.context);
  }
  log.report_file(Code("E5001"), {},
                  fmt::format("no OpenGL 4.5 context: with EGL {}; with OSMesa {}", software.reason,
                              osmesa.reason));
  return failed;
}

}  // namespace panwright::preview
