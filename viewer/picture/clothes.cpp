#include "viewer/picture/clothes.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "viewer/picture/palette_text.h"

namespace throng {
namespace {

using Choices = std::vector<Eigen::Vector3f>;

/// Converts "#rrggbb" to linear light.
Eigen::Vector3f linear(const std::string& hex) {
  Eigen::Vector3f rgb;
  for (int i = 0; i < 3; ++i) {
    const float c =
        static_cast<float>(std::stoi(hex.substr(1 + 2 * static_cast<size_t>(i), 2), nullptr, 16)) /
        255;
    rgb[i] = c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
  }
  return rgb;
}

struct Palette {
  Palette() {
    const auto json = nlohmann::json::parse(kPaletteText);
    const auto colours = [&](const char* name) {
      Choices all;
      for (const auto& hex : json.at(name)) all.push_back(linear(hex.get<std::string>()));
      return all;
    };
    marks = colours("marks");
    by_slot = {colours("shirts"), colours("trousers"), colours("skins"), colours("hairs"),
               colours("shoes")};
  }
  Choices marks;
  std::array<Choices, 5> by_slot;
};

const Palette& palette() {
  static const Palette palette;
  return palette;
}

/// scatter() of the page's theme.ts.
uint32_t scatter(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}

bool names(std::string_view text, std::string_view word) {
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  return std::search(text.begin(), text.end(), word.begin(), word.end(), same) != text.end();
}

}  // namespace

Slot slot_of(std::string_view part_name) {
  if (names(part_name, "head") || names(part_name, "hand")) return Slot::kSkin;
  if (names(part_name, "foot")) return Slot::kShoes;
  if (names(part_name, "leg") || names(part_name, "pelvis")) return Slot::kTrousers;
  return Slot::kShirt;
}

Eigen::Vector3f clothes_rgb(Slot slot, uint32_t avatar) {
  const auto index = static_cast<size_t>(slot);
  const Choices& colours = palette().by_slot[index];
  return colours[(scatter(avatar + 1) >> (4 * index)) % colours.size()];
}

Eigen::Vector3f mark_rgb(PairLevel level) {
  return palette().marks[1 + static_cast<size_t>(level)];  // the first is that of candidates
}

void add_hair(const Part& part, Shape& shape) {
  if (!names(part.name, "head")) return;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : part.mesh.vertices) box.extend(p);
  for (const Eigen::Vector3f& p : shape.vertices) {
    const Eigen::Vector3f at = (p - box.center()).cwiseQuotient(0.5F * box.sizes());
    shape.is_second.push_back(at.z() > 0.5F || (at.x() < -0.1F && at.z() > -0.35F));
  }
}

}  // namespace throng
