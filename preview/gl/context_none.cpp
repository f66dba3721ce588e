// The build without OpenGL: no context can be had.
#include "preview/context.h"

struct GladGLContext {};

namespace panwright::preview {

Context::Context() = default;
Context::~Context() = default;
bool Context::make_current() { return false; }
void Context::release() {}
std::string Context::load() { return "built without OpenGL"; }

Result<std::unique_ptr<Context>> Context::create(ContextKind, DiagnosticLog& log) {
  log.report_file(Code("E5007"), {},
                  "this program was built without OpenGL; build with PANWRIGHT_GL=ON to render");
  return failed;
}

}  // namespace panwright::preview
