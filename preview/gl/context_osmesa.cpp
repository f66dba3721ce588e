#include <GL/osmesa.h>
#include <dlfcn.h>

#include <array>
#include <cstdint>

#include "base/heap.h"
#include "preview/gl/context_kinds.h"

namespace panwright::preview {
namespace {

struct OsmesaLibrary {
  OSMesaContext (*create)(const int*, OSMesaContext) = nullptr;
  void (*destroy)(OSMesaContext) = nullptr;
  GLboolean (*make_current)(OSMesaContext, void*, GLenum, GLsizei, GLsizei) = nullptr;
  OSMESAproc (*get_proc)(const char*) = nullptr;
  std::string reason;  // why it cannot be used; empty: it can
};

OsmesaLibrary opened_osmesa() {
  OsmesaLibrary osmesa;
  void* handle = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    osmesa.reason = "libOSMesa.so.8 cannot be opened_osmesa";
    return osmesa;
  }
  const auto find = [&](const char* name, auto& function) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle, name));
    if (!function) osmesa.reason = std::string("libOSMesa.so.8 has no ") + name;
  };
  find("OSMesaCreateContextAttribs", osmesa.create);
  find("OSMesaDestroyContext", osmesa.destroy);
  find("OSMesaMakeCurrent", osmesa.make_current);
  find("OSMesaGetProcAddress", osmesa.get_proc);
  return osmesa;
}

const OsmesaLibrary& osmesa() {
  static const OsmesaLibrary instance = opened_osmesa();
  return instance;
}

class OsmesaContext final : public Context {
 public:
  ~OsmesaContext() override {
    release();
    if (handle_) osmesa().destroy(handle_);
  }

  std::string open() {
    constexpr std::array<int, 16> kAttributes{OSMESA_FORMAT,
                                              OSMESA_RGBA,
                                              OSMESA_DEPTH_BITS,
                                              0,
                                              OSMESA_STENCIL_BITS,
                                              0,
                                              OSMESA_ACCUM_BITS,
                                              0,
                                              OSMESA_PROFILE,
                                              OSMESA_CORE_PROFILE,
                                              OSMESA_CONTEXT_MAJOR_VERSION,
                                              4,
                                              OSMESA_CONTEXT_MINOR_VERSION,
                                              5,
                                              0,
                                              0};
    handle_ = osmesa().create(kAttributes.data(), nullptr);
    if (!handle_) return "it gives no OpenGL 4.5 core context";
    return load();
  }

  Proc get_proc(const char* name) const override { return osmesa().get_proc(name); }
  ContextKind kind() const override { return ContextKind::osmesa; }

 private:
  bool bind() override {
    return osmesa().make_current(handle_, buffer_.data(), GL_UNSIGNED_BYTE, kSide, kSide) ==
           GL_TRUE;
  }
  void unbind() override { osmesa().make_current(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

  // OSMesa insists on a buffer of its own; everything is drawn into framebuffer objects
  static constexpr int kSide = 16;
  std::array<std::uint8_t, std::size_t{4} * kSide * kSide> buffer_{};
  OSMesaContext handle_ = nullptr;
};

}  // namespace

ContextAttempt create_osmesa_context() {
  if (!osmesa().reason.empty()) return {nullptr, osmesa().reason};
  auto context = std::make_unique<OsmesaContext>();
  std::string reason = context->open();
  if (!reason.empty()) return {nullptr, std::move(reason)};
  keep_freed_memory();
  return {std::move(context), {}};
}

}  // namespace panwright::preview
