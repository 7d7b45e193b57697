#include "geometry/wkt.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

constexpr int kMaxDepth = 8;
constexpr double kMaxCoordinate = 1e12;

class Parser {
 public:
  Parser(std::string_view text, const std::string& where) : rest_(text), where_(where) {}

  std::vector<Polygon> parse() {
    geometry(0);
    skip_blanks();
    if (!rest_.empty()) reject("nothing after the geometry");
    if (out_.empty()) reject("at least one polygon");
    return std::move(out_);
  }

 private:
  void geometry(int depth) {
    if (depth > kMaxDepth) reject("collections at most 8 deep");
    const std::string kind = word();
    constexpr const char* kAreas = "POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION";
    if (kind.empty()) reject(kAreas);
    if (kind != "POLYGON" && kind != "MULTIPOLYGON" && kind != "GEOMETRYCOLLECTION")
      throw InputError(where_, fmt::format("only {} in the walkable area (WKT)", kAreas),
                       kind.substr(0, 40) + (depth > 0 ? "; leave it out of the collection"
                                                       : "; state the area as polygons"));
    if (starts_with_letter()) {
      const std::string next = word();
      if (next == "EMPTY") return;
      if (next != "Z" && next != "M" && next != "ZM") reject("(");
    }
    if (kind == "POLYGON")
      polygon();
    else
      list([&] { kind == "MULTIPOLYGON" ? polygon() : geometry(depth + 1); });
  }

  void polygon() {
    Polygon polygon;
    bool has_outline = false;
    list([&] {
      Polygon::Ring ring = this->ring();
      if (!std::exchange(has_outline, true))
        polygon.outline = std::move(ring);
      else
        polygon.holes.push_back(std::move(ring));
    });
    out_.push_back(std::move(polygon));
  }

  Polygon::Ring ring() {
    Polygon::Ring ring;
    list([&] {
      const double x = number();
      const double y = number();
      skip_blanks();
      while (!rest_.empty() && rest_[0] != ',' && rest_[0] != ')') {
        number();
        skip_blanks();
      }
      if (++vertices_ > kMaxVertices) reject("at most 100000 vertices");
      ring.emplace_back(x, y);
    });
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    if (ring.size() < 3) reject("rings of three vertices or more");
    return ring;
  }

  template <typename Item>
  void list(const Item& item) {
    expect('(');
    item();
    skip_blanks();
    while (!rest_.empty() && rest_[0] == ',') {
      rest_.remove_prefix(1);
      item();
      skip_blanks();
    }
    expect(')');
  }

  double number() {
    skip_blanks();
    double value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc() || !(std::abs(value) <= kMaxCoordinate)) reject("a coordinate");
    rest_.remove_prefix(static_cast<size_t>(end - rest_.data()));
    return value;
  }

  std::string word() {
    skip_blanks();
    std::string out;
    while (starts_with_letter()) {
      out += static_cast<char>(std::toupper(static_cast<unsigned char>(rest_[0])));
      rest_.remove_prefix(1);
    }
    skip_blanks();
    return out;
  }

  bool starts_with_letter() const {
    return !rest_.empty() && std::isalpha(static_cast<unsigned char>(rest_[0])) != 0;
  }
  void skip_blanks() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_[0])) != 0)
      rest_.remove_prefix(1);
  }
  void expect(char c) {
    skip_blanks();
    if (rest_.empty() || rest_[0] != c) reject(std::string("'") + c + "'");
    rest_.remove_prefix(1);
  }
  [[noreturn]] void reject(const std::string& expected) const {
    throw InputError(where_, expected + " in the walkable area (WKT)",
                     rest_.empty() ? "its end" : in_quotes(rest_.substr(0, 40)));
  }

  std::string_view rest_;
  const std::string& where_;
  size_t vertices_ = 0;
  std::vector<Polygon> out_;
};

}  // namespace

std::vector<Polygon> parse_wkt(std::string_view wkt, const std::string& where) {
  return Parser(wkt, where).parse();
}

}  // namespace throng
