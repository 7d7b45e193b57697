#include "kinematics/plain_urdf.h"

#include <fmt/format.h>

#include <initializer_list>
#include <string_view>

namespace throng {
namespace {

std::string in_xml(std::string_view value) {
  std::string out;
  for (const char c : value) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

class Writer {
 public:
  Writer(const std::vector<XmlElement>& elements, const UrdfUse& use)
      : elements_(elements), use_(use) {}

  std::string text() {
    out_ = "<robot name=\"robot\">\n";
    for (int i = at(0).first_child; i >= 0; i = at(i).next_sibling) {
      if (use_.skipped[static_cast<size_t>(i)]) continue;
      if (at(i).name == "link") write_link(i);
      if (at(i).name == "joint") write_joint(i);
    }
    return std::move(out_) + "</robot>\n";
  }

 private:
  const XmlElement& at(int element) const { return elements_[static_cast<size_t>(element)]; }

  /// The start of a tag with those of the attributes that the element has.
  void open(std::string_view tag, int element, std::initializer_list<std::string_view> attributes,
            std::string_view more = "") {
    out_ += fmt::format("<{}", tag);
    for (const std::string_view attribute : attributes)
      if (const std::string* value = at(element).attribute(attribute))
        out_ += fmt::format(" {}=\"{}\"", attribute, in_xml(*value));
    out_ += fmt::format("{}>", more);
  }

  /// The same of a child, if there is one.
  void write_child(int element, std::string_view tag,
                   std::initializer_list<std::string_view> attributes, std::string_view more = "") {
    const int child = child_of(elements_, element, tag);
    if (child >= 0) open(tag, child, attributes, fmt::format("{}/", more));
  }

  void write_link(int link) {
    open("link", link, {"name"});
    for (int i = at(link).first_child; i >= 0; i = at(i).next_sibling)
      if ((at(i).name == "visual" || at(i).name == "collision") &&
          !use_.skipped[static_cast<size_t>(i)])
        write_shape(i);
    out_ += "</link>\n";
  }

  void write_shape(int owner) {
    out_ += fmt::format("<{}>", at(owner).name);
    write_child(owner, "origin", {"xyz", "rpy"});
    const int shape = at(child_of(elements_, owner, "geometry")).first_child;
    out_ += "<geometry>";
    open(at(shape).name == "capsule" ? "cylinder" : at(shape).name, shape,
         {"size", "radius", "length", "filename", "scale"}, "/");
    out_ += fmt::format("</geometry></{}>\n", at(owner).name);
  }

  void write_joint(int joint) {
    const std::string& given = *at(joint).attribute("type");
    const std::string type = given == "spherical" ? "fixed" : given;
    const bool has_limit = child_of(elements_, joint, "limit") >= 0;
    out_ += fmt::format("<joint name=\"{}\" type=\"{}\">", in_xml(*at(joint).attribute("name")),
                        type == "revolute" && !has_limit ? "continuous" : type);
    write_child(joint, "parent", {"link"});
    write_child(joint, "child", {"link"});
    write_child(joint, "origin", {"xyz", "rpy"});
    if (type != "fixed") {
      write_child(joint, "axis", {"xyz"});
      write_child(joint, "mimic", {"joint", "multiplier", "offset"});
    }
    // urdfdom insists on all four, and Throng uses two.
    constexpr std::string_view kForces = " effort=\"0\" velocity=\"0\"";
    if (type == "revolute" || type == "prismatic") {
      write_child(joint, "limit", {"lower", "upper"}, kForces);
      if (!has_limit && type == "prismatic") out_ += fmt::format("<limit{}/>", kForces);
    }
    out_ += "</joint>\n";
  }

  const std::vector<XmlElement>& elements_;
  const UrdfUse& use_;
  std::string out_;
};

}  // namespace

std::string plain_urdf(const std::vector<XmlElement>& elements, const UrdfUse& use) {
  return Writer(elements, use).text();
}

}  // namespace throng
