#include "tools/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/text.h"
#include "compiler/compile.h"
#include "pxn/pxn.h"

namespace panwright::tools {

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

Result<scene::Scene> read_scene(const std::string& path, const ReadOptions& options,
                                Session& session) {
  session.step("read " + path);
  pxn::Options read;
  read.root = options.root;
  read.limits.bytes = options.max_input;
  for (const std::string& parameter : options.parameters) {
    const std::size_t sign = parameter.find('=');
    if (sign == std::string::npos || sign == 0) {
      session.log().report(
          Code::E0201, {},
          fmt::format("-D {}: NAME=VALUE is needed, as in -D span=2.4m", in_quotes(parameter)));
      return failed;
    }
    read.parameters.emplace_back(parameter.substr(0, sign), parameter.substr(sign + 1));
  }
  return pxn::read(path, read, session.log());
}

Result<pan::Model> load_model(const std::string& path, const ReadOptions& options,
                              Session& session) {
  const std::string extension = extension_of(path);
  if (extension == ".pan") {
    session.step("open " + path);
    auto model = pan::Model::open(path, session.log());
    if (!model) return failed;
    session.step("check " + path);
    if (!model->check(session.log())) return failed;
    return model;
  }
  if (extension != ".pxn") {
    session.log().report(Code::E0202, {},
                         fmt::format("{} is neither a .pan nor a .pxn file", in_quotes(path)));
    return failed;
  }
  const auto scene = read_scene(path, options, session);
  if (!scene) return failed;
  session.step("compile " + path);
  compiler::Options compile;
  compile.max_error = options.max_error;
  compile.max_triangles = options.max_triangles;
  auto bytes = compiler::compiled(*scene, compile, session.log());
  if (!bytes) return failed;
  auto model = pan::Model::from_bytes(*bytes, path, session.log());
  if (!model || !model->check(session.log())) return failed;
  return model;
}

}  // namespace panwright::tools
