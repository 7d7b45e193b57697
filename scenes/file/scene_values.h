// The values that several keys of a scene file share: areas, distributions, shares.
// One rule: what is said of their keys lies beside what reads them.
#pragma once

#include <string>

#include "base/limits.h"
#include "scenes/file/key.h"

namespace throng {

/// Where on the ground anything may be.
inline constexpr Range kPositionRange{-kMaxCoordinate_m, kMaxCoordinate_m};

/// {min_m: [x, y], max_m: [x, y]} with min below max, coordinates within kMaxCoordinate_m. `what`
/// names it in messages: "ground".
Rectangle read_rectangle(const std::string& file, const YamlNode& node, const std::string& what);
/// The same from a map that has other keys, too.
Rectangle read_rectangle(const Fields& fields, const std::string& what);
/// A rectangle within the ground.
Rectangle read_area(const std::string& file, const YamlNode& node, const std::string& what,
                    const Rectangle& ground);
void require_on_ground(const std::string& where, const std::string& what, const Rectangle& area,
                       const Rectangle& ground);
/// "[0, 0] to [8, 5]".
std::string to_text(const Rectangle& area);

/// {mean, deviation, min, max}, each optional, or one number for everybody.
Distribution read_distribution(const std::string& file, const YamlNode& node,
                               const std::string& what, const Distribution& fallback,
                               const Range& range);

/// The shares of a group's ages (adults only, if it does not say) and styles.
AgeShares read_ages(const Fields& group);
StyleShares read_styles(const Fields& group, const YamlNode& node);

/// A URDF: of the bundled adult, or a file relative to the scene's.
std::filesystem::path read_model_file(const ReadContext& context, const Fields& fields);
/// A regular file, its name relative to the scene's; `expected` describes it in messages.
std::filesystem::path existing_file(const ReadContext& context, const Fields& fields,
                                    const YamlNode& node, const std::string& expected);

/// Throws InputError if these are more than ids go round for.
void require_few(const std::string& where, int64_t people_and_obstacles);
/// Throws InputError if there has been one of this name.
void require_new(const Fields& fields, const std::string& name, std::set<std::string>& earlier);

/// What is said of these maps.
MapText area_text();
MapText distribution_text();
MapText ages_text();
MapText styles_text();

}  // namespace throng
