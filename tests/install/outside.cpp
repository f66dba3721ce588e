// What an outside program does with the installed libraries: compile a model, open it, count.
#include <cstdio>

#include "compiler/compile.h"
#include "pan/model.h"
#include "pxn/pxn.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  panwright::DiagnosticLog log;
  const auto scene = panwright::pxn::read(argv[1], {}, log);
  if (!scene || !panwright::compiler::compile(*scene, {}, argv[2], log)) {
    std::fputs(panwright::to_text(log).c_str(), stderr);
    return panwright::exit_code(log);
  }
  const auto model = panwright::pan::Model::load(argv[2], log);
  if (!model) return 1;
  std::printf("%zu meshes\n", model->meshes().size());
  return 0;
}
