// Pixels on their way from framebuffers into memory. Private to preview.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/job.h"
#include "preview/gl/gl_objects.h"

namespace panwright::preview {

// How one pixel is stored in a framebuffer and in memory.
struct PixelFormat {
  GLenum internal = GL_RGBA32F;
  GLenum format = GL_RGBA;
  GLenum type = GL_FLOAT;
  std::size_t bytes = 16;
};

// A ring of framebuffers of one color: while one is read, the next one is drawn. Nothing waits but
// take().
//
// Where the context draws beside this thread's processor, pixels are copied into a buffer as soon
// as they are drawn, and looked at once a fence has passed. A context in software copies on the
// thread that asks, after all that it was told to draw: there the fence comes first, then the copy.
class ReadBack {
 public:
  static constexpr std::size_t kSlots = 2;

  // through_buffers: whether pixels go through a buffer of the context
  ReadBack(const GladGLContext& gl, const PixelFormat& format, bool through_buffers)
      : gl_(gl), format_(format), through_buffers_(through_buffers) {}
  ~ReadBack() { drop(); }
  ReadBack(const ReadBack&) = delete;
  ReadBack& operator=(const ReadBack&) = delete;

  const PixelFormat& format() const { return format_; }
  bool empty() const { return used_ == 0; }
  bool full() const { return used_ == kSlots; }
  std::size_t oldest() const { return first_; }  // number of a slot. Expects: !empty()
  std::size_t newest() const { return (first_ + used_ - 1) % kSlots; }
  std::size_t next() const { return (first_ + used_) % kSlots; }  // Expects: !full()

  // What the next pixels are drawn into. Expects: !full().
  RenderTarget& target() { return slots_[next()].target; }

  // The pixels [0, width) × [0, height) of target() are drawn, as far as this thread goes: takes
  // the next slot. False: the context has no memory for them.
  bool submit(std::uint32_t width, std::uint32_t height);

  enum class Wait { done, cancelled, failed };
  // Waits for the oldest pixels, calls use with them, rows as they stand in the framebuffer, and
  // frees the slot; where they did not come, it stays. Expects: !empty().
  Wait take(const Job& job, const std::function<void(const void*)>& use);

  // Forgets the newest pixels, or all. current: whether the context is.
  void drop_newest(bool current = true);
  void drop(bool current = true);

 private:
  struct Slot {
    RenderTarget target;
    GlBuffer buffer;
    const void* mapped = nullptr;  // of the buffer, as long as it lives
    std::size_t buffer_bytes = 0;
    GLsync drawn = nullptr;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
  };
  bool ensure_buffer(Slot& slot, std::size_t bytes);
  void forget(Slot& slot, bool current);

  const GladGLContext& gl_;
  const PixelFormat format_;
  const bool through_buffers_;
  std::array<Slot, kSlots> slots_;
  std::size_t first_ = 0;
  std::size_t used_ = 0;
  std::vector<std::byte> memory_;  // of copies that need no buffer
};

// Waits until all that was told to the context so far is drawn, with polls of the job.
ReadBack::Wait wait_until_drawn(const GladGLContext& gl, const Job& job);

}  // namespace panwright::preview
