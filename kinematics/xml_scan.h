// A first look at an XML text, before a parser that recurses is let loose on it.
// One rule: never recurses, never trusts a size; what it returns is well nested and within the
// caps.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace throng {

/// One start tag. Elements stand in document order, so a parent comes before its children.
struct XmlElement {
  std::string_view name;  ///< points into the scanned text
  std::vector<std::pair<std::string_view, std::string>>
      attributes;   ///< values with entities decoded
  int line = 1;     ///< of the '<'
  int parent = -1;  ///< index of the enclosing element
  int first_child = -1;
  int next_sibling = -1;
  size_t end = 0;  ///< offset behind the tag that closes it

  /// The attribute's value, or null if it is not there.
  const std::string* attribute(std::string_view attribute_name) const;
};

struct XmlLimits {
  size_t bytes;
  int depth;
  int elements;
  size_t value_bytes;  ///< of one attribute
  size_t attributes;   ///< of one tag
  size_t name_bytes;   ///< of a tag or an attribute
};

/// Tags, attributes and line numbers of `text`; character data is skipped. Throws InputError
/// "file:line: ..." for text that is not XML, badly nested, or over a cap.
std::vector<XmlElement> scan_xml(std::string_view text, const std::string& file,
                                 const XmlLimits& limits);

/// The name of the first start tag of `text`, which may be the head of a longer one; empty if the
/// text begins otherwise than an XML text does, or ends before.
std::string_view root_tag_of(std::string_view text);

/// First child of that name, or -1.
int child_of(const std::vector<XmlElement>& elements, int parent, std::string_view name);

}  // namespace throng
