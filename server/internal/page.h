// Files held in the program. Private to server.
#pragma once

#include <string>

namespace panwright::server {

std::string page_text();  // server/page/page.html

}  // namespace panwright::server
