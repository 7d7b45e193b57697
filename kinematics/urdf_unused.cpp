#include "kinematics/urdf_unused.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

#include "base/text.h"

namespace throng {
namespace {

struct Use {
  std::string_view tag;
  std::string_view note;  ///< empty: used, or told under its owner
};

constexpr std::array kKnownTags{
    Use{"link", ""},
    Use{"joint", ""},
    Use{"origin", ""},
    Use{"parent", ""},
    Use{"child", ""},
    Use{"axis", ""},
    Use{"limit", ""},
    Use{"mimic", ""},
    Use{"visual", ""},
    Use{"collision", ""},
    Use{"geometry", ""},
    Use{"mesh", ""},
    Use{"box", ""},
    Use{"cylinder", ""},
    Use{"capsule", ""},
    Use{"sphere", ""},
    Use{"mass", ""},
    Use{"inertial", "the mass is read, the inertia is not used"},
    Use{"inertia", ""},
    Use{"material", "colours and textures are not used"},
    Use{"dynamics", "friction and damping are not used"},
    Use{"calibration", "not used"},
    Use{"safety_controller", "soft limits are not used, <limit> is"},
    Use{"transmission", "drives are not simulated"},
    Use{"gazebo", "extensions for Gazebo are not used"},
    Use{"ros2_control", "controllers are not used"},
    Use{"sensor", "sensors are not simulated"},
};

}  // namespace

std::vector<std::string> unused_in_urdf(const std::vector<XmlElement>& elements) {
  std::map<std::string, std::pair<int, std::string_view>> counts;
  std::vector<bool> told(elements.size(), false);  // an unused tag speaks for all inside it
  for (size_t i = 1; i < elements.size(); ++i) {
    const size_t parent = static_cast<size_t>(elements[i].parent);
    told[i] = told[parent];
    if (told[i]) continue;
    const auto* known = std::find_if(kKnownTags.begin(), kKnownTags.end(),
                                     [&](const Use& use) { return use.tag == elements[i].name; });
    if (known != kKnownTags.end() && known->note.empty()) continue;
    const bool understood = known != kKnownTags.end();
    told[i] = elements[i].name != "inertial";
    const std::string key = fmt::format("<{}>", escaped(elements[i].name.substr(0, 60)));
    auto& entry = counts.emplace(key, std::pair{0, understood ? known->note : "not understood"})
                      .first->second;
    ++entry.first;
  }
  constexpr size_t kMostTags = 60;  // a page; the rest is a number
  std::vector<std::string> notes;
  for (const auto& [tag, count] : counts) {
    if (notes.size() == kMostTags) {
      notes.push_back(fmt::format("and {} more tags: not understood", counts.size() - kMostTags));
      break;
    }
    notes.push_back(fmt::format("{} x{}: {}", tag, count.first, count.second));
  }
  return notes;
}

}  // namespace throng
