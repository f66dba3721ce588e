#include "tools/report_page.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "tools/templates.h"

namespace panwright::tools {

std::string report_page(const std::string& title, const nlohmann::ordered_json& report) {
  using Json = nlohmann::ordered_json;
  Json all{{"title", title}};
  all.update(report);
  std::string text = all.dump(-1, ' ', true, Json::error_handler_t::replace);
  // would end the element, or begin a comment
  for (std::size_t at = 0; (at = text.find('<', at)) != text.npos;) text.replace(at, 1, "\\u003c");
  std::string page = report_template_text();
  constexpr std::string_view kPlace = "@report@";
  return page.replace(page.find(kPlace), kPlace.size(), text);
}

}  // namespace panwright::tools
