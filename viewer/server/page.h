// The page of `throng view`: one HTML file with its script and style inside, built from
// viewer/page. One rule: it names no address but the server it came from.
#pragma once

#include <string_view>

namespace throng {

std::string_view page_html();

}  // namespace throng
