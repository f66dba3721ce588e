// The build without OpenGL: there is no context, so nothing here is ever rendered.
#include "preview/renderer.h"

namespace panwright::preview {

struct Renderer::Impl {};

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Result<Renderer> Renderer::create(Context&, const pan::Model&, DiagnosticLog& log) {
  log.report_file(Code::E5007, {}, "this program was built without OpenGL");
  return failed;
}

Result<Image> Renderer::render(const View&, const RenderOptions&, DiagnosticLog& log) {
  log.report_file(Code::E5007, {}, "this program was built without OpenGL");
  return failed;
}

std::uint64_t Renderer::triangles() const { return 0; }
double Renderer::seconds_of_bare_draw(const View&) { return 0; }

}  // namespace panwright::preview
