// page_html() returns the page of `throng view`: one HTML file, built from viewer/page.
// Invariant: the page names no address but the server it came from.
#pragma once

#include <string_view>

namespace throng {

std::string_view page_html();

}  // namespace throng
