// scan_xml() checks an XML text before a recursive parser reads it.
// Invariant: it does not recurse and does not trust stated sizes; its result is well nested and
// within the limits.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace throng {

/// One start tag. Elements are in document order: a parent comes before its children.
struct XmlElement {
  std::string_view name;  ///< points into the scanned text
  std::vector<std::pair<std::string_view, std::string>>
      attributes;   ///< values with entities decoded
  int line = 1;     ///< line of the '<'
  int parent = -1;  ///< index of the enclosing element
  int first_child = -1;
  int next_sibling = -1;
  size_t end = 0;  ///< offset behind the closing tag

  const std::string* attribute(std::string_view attribute_name) const;
};

struct XmlLimits {
  size_t bytes;
  int depth;
  int elements;
  size_t value_bytes;  ///< maximum length of an attribute's value
  size_t attributes;   ///< maximum number of attributes per tag
  size_t name_bytes;   ///< maximum length of a tag's or an attribute's name
};

/// Returns tags, attributes and line numbers of `text`; character data is skipped. Throws
/// InputError "file:line: ..." for text that is not XML, badly nested, or over a limit.
std::vector<XmlElement> scan_xml(std::string_view text, const std::string& file,
                                 const XmlLimits& limits);

/// Returns the name of the first start tag of `text`, which may be the head of a longer text. Empty
/// if the text does not begin like XML, or ends before.
std::string_view root_tag_of(std::string_view text);

/// Returns the first child with this name, or -1.
int child_of(const std::vector<XmlElement>& elements, int parent, std::string_view name);

}  // namespace throng
