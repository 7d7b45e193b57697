// xml_text() escapes a text for the content of an XML element.
#pragma once

#include <string>
#include <string_view>

namespace throng {

/// Content of an element, not of an attribute: quotes stay. The text is valid UTF-8 without control
/// characters, see escaped().
inline std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

}  // namespace throng
