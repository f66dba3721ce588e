#include "preview/frame/read_back.h"

#include <algorithm>

namespace panwright::preview {
namespace {

// how long a job that is cancelled may go unheard
constexpr GLuint64 kPollNanoseconds = 10'000'000;

ReadBack::Wait wait_for(const GladGLContext& gl, GLsync drawn, const Job& job) {
  while (true) {
    if (job.cancelled()) return ReadBack::Wait::cancelled;
    switch (gl.ClientWaitSync(drawn, GL_SYNC_FLUSH_COMMANDS_BIT, kPollNanoseconds)) {
      case GL_ALREADY_SIGNALED:
      case GL_CONDITION_SATISFIED:
        return ReadBack::Wait::done;
      case GL_TIMEOUT_EXPIRED:
        break;
      default:
        return ReadBack::Wait::failed;
    }
  }
}

}  // namespace

ReadBack::Wait wait_until_drawn(const GladGLContext& gl, const Job& job) {
  const GLsync drawn = gl.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  if (!drawn) return ReadBack::Wait::failed;
  const ReadBack::Wait result = wait_for(gl, drawn, job);
  gl.DeleteSync(drawn);
  return result;
}

bool ReadBack::ensure_buffer(Slot& slot, std::size_t bytes) {
  if (slot.buffer_bytes >= bytes) return true;
  slot.buffer = {};  // first, so that memory need not hold both
  slot.mapped = nullptr;
  slot.buffer_bytes = 0;
  slot.buffer = make_stream_buffer(gl_);
  constexpr GLbitfield kAccess = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  const auto size = static_cast<GLsizeiptr>(bytes);
  gl_.NamedBufferStorage(slot.buffer.id(), size, nullptr, kAccess | GL_CLIENT_STORAGE_BIT);
  slot.mapped = gl_.MapNamedBufferRange(slot.buffer.id(), 0, size, kAccess);
  if (slot.mapped) slot.buffer_bytes = bytes;
  return slot.mapped != nullptr;
}

bool ReadBack::submit(std::uint32_t width, std::uint32_t height) {
  Slot& slot = slots_[next()];
  slot.width = width;
  slot.height = height;
  if (through_buffers_) {
    if (!ensure_buffer(slot, std::size_t{width} * height * format_.bytes)) return false;
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, slot.target.framebuffer.id());
    gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, slot.buffer.id());
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl_.ReadPixels(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height), format_.format,
                   format_.type, nullptr);
    gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  }
  slot.drawn = gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  if (!slot.drawn) return false;
  gl_.Flush();
  ++used_;
  return true;
}

ReadBack::Wait ReadBack::take(const Job& job, const std::function<void(const void*)>& use) {
  Slot& slot = slots_[first_];
  const Wait result = wait_for(gl_, slot.drawn, job);
  if (result != Wait::done) return result;
  const void* pixels = slot.mapped;
  if (!through_buffers_) {
    // kept between views: fresh memory costs as much as a tenth of a draw
    memory_.resize(std::max(memory_.size(), std::size_t{slot.width} * slot.height * format_.bytes));
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, slot.target.framebuffer.id());
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl_.ReadPixels(0, 0, static_cast<GLsizei>(slot.width), static_cast<GLsizei>(slot.height),
                   format_.format, format_.type, memory_.data());
    pixels = memory_.data();
  }
  use(pixels);
  forget(slot, true);
  first_ = (first_ + 1) % kSlots;
  --used_;
  return Wait::done;
}

void ReadBack::forget(Slot& slot, bool current) {
  if (slot.drawn && current) gl_.DeleteSync(slot.drawn);
  slot.drawn = nullptr;
}

void ReadBack::drop_newest(bool current) {
  forget(slots_[newest()], current);
  --used_;
}

void ReadBack::drop(bool current) {
  while (!empty()) drop_newest(current);
}

}  // namespace panwright::preview
