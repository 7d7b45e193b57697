#include "scenes/file/scene_values.h"

#include <algorithm>
#include <cctype>

#include "base/errors.h"
#include "base/limits.h"
#include "crowd/crowd_plan.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

/// Range of the share of one age or style; only ratios count.
constexpr Range kShareRange{0, 1e6};
constexpr Range kCoordinateRange{-kMaxCoordinate_m, kMaxCoordinate_m};

KeyText share(const std::string& name, std::string_view meaning) {
  return {
      name, std::string(meaning), "0", false, {.kind = Rule::Kind::kNumber, .range = kShareRange}};
}

[[noreturn]] void reject_word(const Fields& fields, const YamlNode& node, const std::string& what,
                              const std::vector<std::string>& words) {
  throw InputError(fields.where(node),
                   fmt::format("{} ({}), or a map of shares", what, list_of(words)),
                   describe(node) + did_you_mean(node.scalar, words));
}

template <typename Shares>
Shares read_shares(const std::string& file, const YamlNode& node, const std::string& what,
                   const std::vector<std::string>& names) {
  const Fields fields(file, node, what);
  fields.expect_keys(names);
  Shares shares{};
  for (size_t i = 0; i < shares.size(); ++i) shares[i] = fields.number_or(names[i], kShareRange, 0);
  if (std::all_of(shares.begin(), shares.end(), [](double each) { return each == 0; }))
    throw InputError(fields.where(), fmt::format("a share above 0 in {}", what), "none");
  return shares;
}

std::vector<std::string> age_words() {
  std::vector<std::string> words = age_names();
  words.emplace_back("mixed");
  return words;
}

}  // namespace

std::string decimal_text(double value, int decimals) {
  std::string out = fmt::format("{:.{}f}", value, decimals);
  if (decimals > 0) {
    while (out.ends_with('0')) out.pop_back();
    if (out.ends_with('.')) out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

std::string to_text(const Rectangle& r) {
  constexpr int kDecimals = 6;
  const auto corner = [](const Eigen::Vector2d& point) {
    return fmt::format("[{}, {}]", decimal_text(point.x(), kDecimals),
                       decimal_text(point.y(), kDecimals));
  };
  return fmt::format("{} to {}", corner(r.min_m), corner(r.max_m));
}

Rectangle read_rectangle(const Fields& fields, const std::string& what) {
  const std::vector<double> min = fields.numbers("min_m", 2, kCoordinateRange);
  const std::vector<double> max = fields.numbers("max_m", 2, kCoordinateRange);
  if (min[0] >= max[0] || min[1] >= max[1])
    throw InputError(fields.where(), fmt::format("min_m below max_m in {}", what),
                     fmt::format("[{}, {}] and [{}, {}]", min[0], min[1], max[0], max[1]));
  return {{min[0], min[1]}, {max[0], max[1]}};
}

Distribution read_distribution(const std::string& file, const YamlNode& node,
                               const std::string& what, const Distribution& fallback,
                               const Range& range) {
  if (node.kind == YamlNode::Kind::kScalar) {
    const YamlNode wrapper{YamlNode::Kind::kMap,     node.line, "", false, {},
                           {{what, node.line, node}}};
    const double value = Fields(file, wrapper, what).number(what, range);
    return {value, 0, value, value};
  }
  const Fields fields(file, node, what);
  fields.expect_keys({"mean", "std_dev", "min", "max"});
  Distribution out;
  out.mean = fields.number_or("mean", range, fallback.mean);
  out.std_dev = fields.number_or("std_dev", {0, range.max}, fallback.std_dev);
  out.min = fields.number_or("min", range, fallback.min);
  out.max = fields.number_or("max", range, fallback.max);
  if (!(out.min <= out.mean && out.mean <= out.max))
    throw InputError(fields.where(), fmt::format("min <= mean <= max in {}", what),
                     fmt::format("min {}, mean {}, max {}", out.min, out.mean, out.max));
  return out;
}

AgeShares read_ages(const Fields& group) {
  const YamlNode* node = group.find("ages");
  if (node == nullptr) return kAdultsOnly;
  if (node->kind == YamlNode::Kind::kMap)
    return read_shares<AgeShares>(group.file(), *node, "ages", age_names());
  const std::optional<AgeShares> named = ages_of(node->scalar);
  if (named && node->kind == YamlNode::Kind::kScalar) return *named;
  reject_word(group, *node, "ages", age_words());
}

StyleShares read_styles(const Fields& group, const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kMap)
    return read_shares<StyleShares>(group.file(), node, "gait_styles", style_names());
  const std::optional<StyleShares> named = styles_of(node.scalar);
  if (named && node.kind == YamlNode::Kind::kScalar) return *named;
  reject_word(group, node, "gait_styles", style_names());
}

fs::path read_model_file(const ReadContext& context, const Fields& fields) {
  const YamlNode* node = fields.find("model");
  if (node == nullptr || node->scalar == "adult") return adult_urdf();
  if (node->kind != YamlNode::Kind::kScalar)
    throw InputError(fields.where(*node), "'adult' or a URDF file for 'model'", describe(*node));
  return existing_file(context, fields, *node, "'adult' or a URDF file");
}

fs::path existing_file(const ReadContext& context, const Fields& fields, const YamlNode& node,
                       const std::string& expected) {
  if (node.scalar.empty()) throw InputError(fields.where(node), expected, "no name");
  std::error_code error;
  fs::path path = fs::absolute(context.folder / node.scalar, error).lexically_normal();
  if (!fs::is_regular_file(path, error))
    throw InputError(fields.where(node), expected,
                     fmt::format("'{}', and no {} file at {}", node.scalar,
                                 fs::exists(path, error) ? "regular" : "such", path.string()));
  return path;
}

void require_few(const std::string& where, int64_t people_and_obstacles) {
  if (people_and_obstacles > kMaxBodies)
    throw InputError(where, fmt::format("at most {} people and obstacles", kMaxBodies),
                     fmt::format("{}", people_and_obstacles));
}

void require_new(const Fields& fields, const std::string& name, std::set<std::string>& earlier) {
  if (!earlier.insert(name).second)
    throw InputError(fields.where(), "every name once", fmt::format("'{}' again", name));
}

MapText distribution_text() {
  const auto figure = [](const std::string& name, const std::string& meaning) {
    return KeyText{name,
                   meaning,
                   "that of the key with this distribution",
                   false,
                   {.kind = Rule::Kind::kNumber, .range = {0, 1e7}}};
  };
  return {.name = "distribution",
          .meaning = "One number for all agents, or a truncated normal distribution",
          .keys = {figure("mean", "mean"), figure("std_dev", "standard deviation"),
                   figure("min", "lower limit; lower draws are repeated"),
                   figure("max", "upper limit; higher draws are repeated")},
          .or_number = true};
}

MapText ages_text() {
  MapText text{.name = "ages",
               .meaning = "One age, `mixed` (passers-by of a town), or shares of ages",
               .or_words = age_words(),
               .at_least_one = true};
  for (size_t age = 0; age < kAgeCount; ++age) {
    const AgeGroup& group = age_group(static_cast<Age>(age));
    text.keys.push_back(share(std::string(group.name), group.meaning));
  }
  return text;
}

MapText styles_text() {
  MapText text{.name = "gait_styles",
               .meaning = "One gait style, or shares of gait styles",
               .or_words = style_names(),
               .at_least_one = true};
  for (const std::string& name : style_names())
    text.keys.push_back(share(name, "share of agents with this style"));
  return text;
}

std::string read_channel(const Fields& fields, const std::string& key) {
  const std::string channel = fields.text(key);
  const auto is_fine = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
  };
  // liblcm rejects channel names of more than 63 characters.
  if (channel.empty() || channel.size() > 63 || channel.starts_with("THRONG_") ||
      !std::all_of(channel.begin(), channel.end(), is_fine))
    throw InputError(fields.where(*fields.find(key)),
                     fmt::format("an LCM channel name for '{}': 1 to 63 letters, digits or '_', "
                                 "not beginning with THRONG_",
                                 key),
                     fmt::format("'{}'", channel));
  return channel;
}

}  // namespace throng
