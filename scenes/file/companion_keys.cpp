// Who of a group walks with whom.
#include <algorithm>

#include "base/errors.h"
#include "scenes/file/key_tables.h"

namespace throng {
namespace {

constexpr Range kShareRange{0, 1};
/// Numbers of parties, relative to each other.
constexpr Range kPartiesRange{0, 1e6};

Key<Companions> parties_key(const std::string& name, const std::string& meaning, size_t index) {
  return own_key<Companions>(name, meaning, fmt::format("{}", Companions{}.sizes[index]),
                             {.kind = Rule::Kind::kNumber, .range = kPartiesRange})
      .reading([name, index](Reading&, Fields& fields, Companions& companions) {
        double& parties = companions.sizes[index];
        parties = fields.number_or(name, kPartiesRange, parties);
      })
      .hashing([index](Hasher& hash, const Companions& companions) {
        hash.add(companions.sizes[index]);
      });
}

void complete_companions(Reading&, const Fields& fields, Companions& companions) {
  const auto& sizes = companions.sizes;
  if (std::all_of(sizes.begin(), sizes.end(), [](double parties) { return parties == 0; }))
    throw InputError(fields.where(), "one of 'pairs', 'threes' and 'fours' above 0", "none");
}

}  // namespace

const KeyTable<Companions>& companion_keys() {
  static const KeyTable<Companions> table = {
      .text = {.name = "companions",
               .meaning = "Who walks with whom: the share of the people, or a map",
               .or_number = true},
      .title = "companions",
      .keys = {number("share", "of the people, how many walk in a party of two to four, 0 to 1",
                      &Companions::share, kShareRange),
               parties_key("pairs", "how many parties are of two, relative to the others", 0),
               parties_key("threes", "of three", 1), parties_key("fours", "of four", 2)},
      .complete = complete_companions};
  return table;
}

Companions read_companions(Reading& reading, const std::string& file, const YamlNode& node) {
  Companions companions;
  if (node.kind == YamlNode::Kind::kScalar) {
    const YamlNode wrapper{
        YamlNode::Kind::kMap, node.line, "", false, {}, {{"companions", node.line, node}}};
    companions.share = Fields(file, wrapper, "companions").number("companions", kShareRange);
    return companions;
  }
  Fields fields(file, node, companion_keys().title);
  read_keys(companion_keys(), reading, fields, companions);
  return companions;
}

}  // namespace throng
