// Stream of views as lines of JSON, and its answers (docs/views.md, docs/json-lines.md).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/shared_images.h"
#include "server/stage.h"
#include "tools/render_report.h"

namespace panwright::tools {

struct ViewLineOptions {
  workspace::Settings defaults;  // values of omitted members
  workspace::RunListener listener;
  // Lines come from other users of the machine or from others: they read no files but those of the
  // defaults, and write below `folder` alone; empty: nowhere.
  bool foreign = false;
  std::filesystem::path folder;
  server::ShownImage shown;  // called after each image; may be empty
};

// Stream of views. Each answer depends on its line and its number alone.
class ViewLines {
 public:
  // Expects: session and log outlive the stream. log: of the run, for its files.
  ViewLines(workspace::ViewSession& session, ViewLineOptions options, const DiagnosticLog& log);

  // Answers a line, both without their ends; empty: a blank line.
  std::string answer(std::string_view line, const Job& job);
  // Answers a line of more than kMaxViewLine bytes.
  std::string answer_to_long_line();

  // Returns the exit code: 0, or that of the worst answer.
  int code() const { return code_; }

 private:
  class Reply;
  bool read(std::string_view line, workspace::View& view, DiagnosticLog& log) const;
  bool is_allowed(const workspace::View& view, DiagnosticLog& log) const;
  bool place(workspace::View& view, DiagnosticLog& log) const;
  void draw(workspace::View& view, Reply& reply, DiagnosticLog& log, const Job& job);
  DiagnosticLog next_log();
  std::string finish(const Reply& reply, const workspace::View& view, const DiagnosticLog& log);

  workspace::ViewSession& session_;
  ViewLineOptions options_;
  const DiagnosticLog& log_;
  std::shared_ptr<FileUses> files_;
  server::SharedImages shared_;
  std::size_t index_ = 0;
  int code_ = 0;
};

}  // namespace panwright::tools
