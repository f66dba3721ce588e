#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <fmt/core.h>

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

EglLibrary opened_egl() {
  EglLibrary egl;
  void* handle = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    egl.reason = "libEGL.so.1 cannot be opened_egl";
    return egl;
  }
  const auto find = [&](const char* name, auto& function) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle, name));
    if (!function) egl.reason = std::string("libEGL.so.1 has no ") + name;
  };
  find("eglGetProcAddress", egl.get_proc);
  find("eglQueryString", egl.query_string);
  find("eglInitialize", egl.initialize);
  find("eglBindAPI", egl.bind_api);
  find("eglCreateContext", egl.create_context);
  find("eglDestroyContext", egl.destroy_context);
  find("eglMakeCurrent", egl.make_current);
  if (!egl.reason.empty()) return egl;
  const auto extension = [&](const char* name, auto& function) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(egl.get_proc(name));
  };
  extension("eglGetPlatformDisplayEXT", egl.platform_display);
  extension("eglQueryDevicesEXT", egl.query_devices);
  extension("eglQueryDeviceStringEXT", egl.query_device_string);
  const char* words = egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  egl.client_extensions = words ? words : "";
  if (!egl.platform_display || !has_word(egl.client_extensions, "EGL_EXT_platform_base"))
    egl.reason = "it cannot open displays by platform";
  return egl;
}

const EglLibrary& egl() {
  static const EglLibrary instance = opened_egl();
  return instance;
}

class EglContext final : public Context {
 public:
  ~EglContext() override {
    release();
    if (handle_ != EGL_NO_CONTEXT) egl().destroy_context(display_, handle_);
  }

  // note: a display is never terminated, because every context on it would die with it
  std::string open(EGLDisplay display) {
    display_ = display;
    if (display_ == EGL_NO_DISPLAY || !egl().initialize(display_, nullptr, nullptr))
      return "its display cannot be opened_egl";
    const char* words = egl().query_string(display_, EGL_EXTENSIONS);
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
    if (!egl().bind_api(EGL_OPENGL_API)) return "it has no OpenGL";
    for (const std::size_t first : {std::size_t{0}, std::size_t{2}}) {
      handle_ = egl().create_context(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT,
                                     kAttributes.data() + first);
      if (handle_ != EGL_NO_CONTEXT) break;
    }
    if (handle_ == EGL_NO_CONTEXT) return "it gives no OpenGL 4.5 core context";
    return load();
  }

  Proc get_proc(const char* name) const override { return egl().get_proc(name); }
  ContextKind kind() const override { return ContextKind::egl; }

 private:
  bool bind() override {
    // note: the API is bound per thread
    return egl().bind_api(EGL_OPENGL_API) &&
           egl().make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, handle_);
  }
  void unbind() override {
    egl().make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext handle_ = EGL_NO_CONTEXT;
};

std::vector<EGLDeviceEXT> devices() {
  if (!egl().query_devices) return {};
  EGLint count = 0;
  if (!egl().query_devices(0, nullptr, &count) || count <= 0) return {};
  std::vector<EGLDeviceEXT> found(static_cast<std::size_t>(count));
  if (!egl().query_devices(count, found.data(), &count)) return {};
  found.resize(static_cast<std::size_t>(count));
  return found;
}

bool is_software(EGLDeviceEXT device) {
  if (!egl().query_device_string) return false;
  const char* words = egl().query_device_string(device, EGL_EXTENSIONS);
  return words && has_word(words, "EGL_MESA_device_software");
}

ContextAttempt on_display(EGLenum platform, void* native) {
  auto context = std::make_unique<EglContext>();
  std::string reason = context->open(egl().platform_display(platform, native, nullptr));
  if (!reason.empty()) return {nullptr, std::move(reason)};
  return {std::move(context), {}};
}

}  // namespace

ContextAttempt create_egl_context(bool hardware_only) {
  if (!egl().reason.empty()) return {nullptr, egl().reason};
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
  if (found.empty()) add_reason("no device found");
  if (hardware_only) return {nullptr, std::move(reasons)};
  if (has_word(egl().client_extensions, "EGL_MESA_platform_surfaceless")) {
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
