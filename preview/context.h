// Off-screen OpenGL contexts, chosen at run time.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "base/diagnostic.h"
#include "base/result.h"

// Functions of one context, as declared by glad's <glad/gl.h>.
struct GladGLContext;

namespace panwright::preview {

enum class ContextKind {
  automatic,  // an EGL device when it is hardware, else OSMesa
  egl,        // an EGL device, hardware first, else Mesa's surfaceless platform
  osmesa,     // Mesa's software renderer: the same bits on every machine of one kind
};

// Parses "auto", "egl", "osmesa". Nothing: another name.
std::optional<ContextKind> context_kind_from_name(std::string_view name);

// Limits of a context; the renderer refuses larger requests.
struct ContextLimits {
  std::uint32_t framebuffer_side = 0;  // pixels
  std::uint32_t texture_side = 0;      // texels
};

// Counts of a context's work so far.
struct ContextCounts {
  // buffers, textures, renderbuffers, framebuffers, vertex arrays, samplers and programs made, and
  // memory allocated for them; without fences
  std::uint64_t allocations = 0;
  std::uint64_t uploaded_bytes = 0;  // into buffers and textures
};

// An OpenGL 4.5 core context without a window. Several may live side by side, of one kind or of
// both; a context is current on one thread at a time. No OpenGL library is linked: the driver is
// opened at run time and stays open.
class Context {
 public:
  // Creates a context and makes it current on this thread.
  //
  // Reports: N5002 when `automatic` falls back. Fails: E5001; E5007 in a build without OpenGL.
  static Result<std::unique_ptr<Context>> create(ContextKind kind, DiagnosticLog& log);

  virtual ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  // Makes the context current on this thread, releasing the previous one. False when the driver
  // refuses, or another thread has it. Cost: nothing when it is current already.
  bool make_current();

  // Leaves this thread without a current context, if this one is current.
  void release();

  // Returns the address of an OpenGL function; null: unknown. Expects: current.
  using Proc = void (*)();
  virtual Proc get_proc(const char* name) const = 0;

  // The loaded functions: context.gl().DrawArrays(…). Expects: current while they are called.
  const GladGLContext& gl() const { return *gl_; }
  ContextCounts counts() const { return counts_; }

  virtual ContextKind kind() const = 0;  // egl or osmesa
  bool is_hardware() const { return hardware_; }
  const std::string& renderer() const { return renderer_; }  // GL_RENDERER
  const std::string& version() const { return version_; }    // GL_VERSION
  const ContextLimits& limits() const { return limits_; }

 protected:
  Context();
  virtual bool bind() = 0;
  virtual void unbind() = 0;
  // Loads the functions and queries the context. Returns the reason it is unusable, or an empty
  // string.
  std::string load();

 private:
  friend struct ContextHooks;

  std::unique_ptr<GladGLContext> gl_;
  std::unique_ptr<GladGLContext> driver_;  // as loaded: gl_ counts, then calls these
  ContextCounts counts_;
  std::string renderer_;
  std::string version_;
  ContextLimits limits_;
  bool hardware_ = false;
  std::atomic<std::thread::id> holder_{};  // the thread on which it is current
};

}  // namespace panwright::preview
