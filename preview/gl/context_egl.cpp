#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "preview/gl/context_kinds.h"

namespace panwright::preview {
namespace {

struct EglLibrary {
  PFNEGLGETPROCADDRESSPROC get_proc = nullptr;
  PFNEGLQUERYSTRINGPROC query_string = nullptr;
  PFNEGLINITIALIZEPROC initialize = nullptr;
  PFNEGLBINDAPIPROC bind_api = nullptr;
  PFNEGLCREATECONTEXTPROC create_context = nullptr;
  PFNEGLDESTROYCONTEXTPROC destroy_context = nullptr;
  PFNEGLMAKECURRENTPROC make_current = nullptr;
  PFNEGLGETPLATFORMDISPLAYEXTPROC platform_display = nullptr;
  PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;             // may be absent
  PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string = nullptr;  // may be absent
  std::string client_extensions;
  std::string reason;  // why it cannot be used; empty: it can
};

bool has_word(std::string_view words, std::string_view word) {
  for (std::size_t at = words.find(word); at != std::string_view::npos;
       at = words.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || words[at - 1] == ' ') && (end == words.size() || words[end] == ' '))
      return true;
  }
  return false;
}

EglLibrary opened() {
  EglLibrary library;
  void* handle = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    library.reason = "libEGL.so.1 cannot be opened";
    return library;
  }
  const auto find = [&](const char* name, auto& function) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle, name));
    if (!function) library.reason = std::string("libEGL.so.1 has no ") + name;
  };
  find("eglGetProcAddress", library.get_proc);
  find("eglQueryString", library.query_string);
  find("eglInitialize", library.initialize);
  find("eglBindAPI", library.bind_api);
  find("eglCreateContext", library.create_context);
  find("eglDestroyContext", library.destroy_context);
  find("eglMakeCurrent", library.make_current);
  if (!library.reason.empty()) return library;
  const auto extension = [&](const char* name, auto& function) {
    function =
        reinterpret_cast<std::remove_reference_t<decltype(function)>>(library.get_proc(name));
  };
  extension("eglGetPlatformDisplayEXT", library.platform_display);
  extension("eglQueryDevicesEXT", library.query_devices);
  extension("eglQueryDeviceStringEXT", library.query_device_string);
  const char* words = library.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  library.client_extensions = words ? words : "";
  if (!library.platform_display || !has_word(library.client_extensions, "EGL_EXT_platform_base"))
    library.reason = "it cannot open displays by platform";
  return library;
}

const EglLibrary& library() {
  static const EglLibrary instance = opened();
  return instance;
}

class EglContext final : public Context {
 public:
  ~EglContext() override {
    release();
    if (handle_ != EGL_NO_CONTEXT) library().destroy_context(display_, handle_);
  }

  // note: a display is never terminated, because every context on it would die with it
  std::string open(EGLDisplay display) {
    display_ = display;
    if (display_ == EGL_NO_DISPLAY || !library().initialize(display_, nullptr, nullptr))
      return "its display cannot be opened";
    const char* words = library().query_string(display_, EGL_EXTENSIONS);
    const std::string extensions = words ? words : "";
    for (const char* needed : {"EGL_KHR_no_config_context", "EGL_KHR_surfaceless_context"})
      if (!has_word(extensions, needed)) return fmt::format("it lacks {}", needed);
    // the first asks to be told when the context is lost, as EGL 1.5 and EGL_KHR_create_context
    // can; EGL_EXT_create_context_robustness adds nothing for OpenGL
    constexpr std::array<EGLint, 9> kAttributes{EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                                EGL_LOSE_CONTEXT_ON_RESET,
                                                EGL_CONTEXT_MAJOR_VERSION,
                                                4,
                                                EGL_CONTEXT_MINOR_VERSION,
                                                5,
                                                EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                EGL_NONE};
    if (!library().bind_api(EGL_OPENGL_API)) return "it has no OpenGL";
    for (const std::size_t first : {std::size_t{0}, std::size_t{2}}) {
      handle_ = library().create_context(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT,
                                         kAttributes.data() + first);
      if (handle_ != EGL_NO_CONTEXT) break;
    }
    if (handle_ == EGL_NO_CONTEXT) return "it gives no OpenGL 4.5 core context";
    return load();
  }

  Proc get_proc(const char* name) const override { return library().get_proc(name); }
  ContextKind kind() const override { return ContextKind::egl; }

 private:
  bool bind() override {
    // note: the API is bound per thread
    return library().bind_api(EGL_OPENGL_API) &&
           library().make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, handle_);
  }
  void unbind() override {
    library().make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext handle_ = EGL_NO_CONTEXT;
};

std::vector<EGLDeviceEXT> devices() {
  if (!library().query_devices) return {};
  EGLint count = 0;
  if (!library().query_devices(0, nullptr, &count) || count <= 0) return {};
  std::vector<EGLDeviceEXT> found(static_cast<std::size_t>(count));
  if (!library().query_devices(count, found.data(), &count)) return {};
  found.resize(static_cast<std::size_t>(count));
  return found;
}

bool is_software(EGLDeviceEXT device) {
  if (!library().query_device_string) return false;
  const char* words = library().query_device_string(device, EGL_EXTENSIONS);
  return words && has_word(words, "EGL_MESA_device_software");
}

ContextAttempt on_display(EGLenum platform, void* native) {
  auto context = std::make_unique<EglContext>();
  std::string reason = context->open(library().platform_display(platform, native, nullptr));
  if (!reason.empty()) return {nullptr, std::move(reason)};
  return {std::move(context), {}};
}

}  // namespace

ContextAttempt create_egl_context(bool hardware_only) {
  if (!library().reason.empty()) return {nullptr, library().reason};
  const std::vector<EGLDeviceEXT> found = devices();
  std::string reasons;
  const auto add_reason = [&](std::string text) {
    if (!reasons.empty()) reasons += ", ";
    reasons += std::move(text);
  };
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (is_software(found[i])) {
      add_reason(fmt::format("device {} draws in software", i));
      continue;
    }
    auto attempt = on_display(EGL_PLATFORM_DEVICE_EXT, found[i]);
    if (attempt.context && attempt.context->is_hardware()) return attempt;
    add_reason(attempt.context ? fmt::format("device {} is {}", i, attempt.context->renderer())
                               : fmt::format("device {}: {}", i, attempt.reason));
    if (attempt.context && !hardware_only) return attempt;
  }
  if (found.empty()) add_reason("there is no device");
  if (hardware_only) return {nullptr, std::move(reasons)};
  if (has_word(library().client_extensions, "EGL_MESA_platform_surfaceless")) {
    auto attempt = on_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
    if (attempt.context) return attempt;
    add_reason(fmt::format("surfaceless: {}", attempt.reason));
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!is_software(found[i])) continue;
    auto attempt = on_display(EGL_PLATFORM_DEVICE_EXT, found[i]);
    if (attempt.context) return attempt;
    add_reason(fmt::format("device {}: {}", i, attempt.reason));
  }
  return {nullptr, std::move(reasons)};
}

}  // namespace panwright::preview
