#include "recordings/walkable_wkt.h"

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

constexpr size_t kMaxVertices = 100'000;
constexpr int kMaxDepth = 8;
constexpr double kMaxCoordinate = 1e12;
constexpr double kOnEdge_m = 1e-3;

class Parser {
 public:
  Parser(std::string_view text, const std::string& where) : rest_(text), where_(where) {}

  std::vector<AreaPolygon> parse() {
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
    AreaPolygon polygon;
    bool has_outline = false;
    list([&] {
      AreaPolygon::Ring ring = this->ring();
      if (!std::exchange(has_outline, true))
        polygon.outline = std::move(ring);
      else
        polygon.holes.push_back(std::move(ring));
    });
    out_.push_back(std::move(polygon));
  }

  AreaPolygon::Ring ring() {
    AreaPolygon::Ring ring;
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
  std::vector<AreaPolygon> out_;
};

double squared_distance(const Eigen::Vector2d& p, const Eigen::Vector2d& from,
                        const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - from).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - from - t * along).squaredNorm();
}

}  // namespace

double doubled_area(const AreaPolygon::Ring& ring) {
  double sum = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& next = ring[(i + 1) % ring.size()];
    sum += ring[i].x() * next.y() - ring[i].y() * next.x();
  }
  return sum;
}

std::vector<AreaPolygon> parse_area(std::string_view wkt, const std::string& where) {
  return Parser(wkt, where).parse();
}

WalkableArea::WalkableArea(const std::vector<AreaPolygon>& polygons) {
  std::vector<Edge> all;
  for (uint32_t i = 0; i < polygons.size(); ++i) {
    const auto add = [&](const AreaPolygon::Ring& ring) {
      for (size_t k = 0; k < ring.size(); ++k)
        all.push_back({ring[k], ring[(k + 1) % ring.size()], i});
    };
    add(polygons[i].outline);
    for (const AreaPolygon::Ring& hole : polygons[i].holes) add(hole);
  }
  bottom_ = std::numeric_limits<double>::infinity();
  top_ = -bottom_;
  for (const Edge& edge : all) {
    bottom_ = std::min(bottom_, edge.from.y() - kOnEdge_m);
    top_ = std::max(top_, edge.from.y() + kOnEdge_m);
  }
  const auto first_slab = [&](const Edge& edge) {
    return slab_of(std::min(edge.from.y(), edge.to.y()) - kOnEdge_m);
  };
  const auto last_slab = [&](const Edge& edge) {
    return slab_of(std::max(edge.from.y(), edge.to.y()) + kOnEdge_m);
  };
  // Number of slabs with a few edges each, fewer if most edges cross many slabs.
  size_t slabs = std::clamp<size_t>(all.size() / 2, 1, 1024);
  for (;; slabs /= 2) {
    slabs_per_m_ = top_ > bottom_ ? static_cast<double>(slabs) / (top_ - bottom_) : 0;
    slab_begin_.assign(slabs + 1, 0);
    size_t copies = 0;
    for (const Edge& edge : all) copies += last_slab(edge) - first_slab(edge) + 1;
    if (slabs == 1 || copies <= 16 * all.size()) break;
  }
  for (const Edge& edge : all)
    for (size_t slab = first_slab(edge); slab <= last_slab(edge); ++slab) ++slab_begin_[slab + 1];
  for (size_t slab = 0; slab < slabs; ++slab) slab_begin_[slab + 1] += slab_begin_[slab];
  edges_.resize(slab_begin_.back());
  std::vector<uint32_t> next(slab_begin_.begin(), slab_begin_.end() - 1);
  for (const Edge& edge : all)
    for (size_t slab = first_slab(edge); slab <= last_slab(edge); ++slab)
      edges_[next[slab]++] = edge;
}

size_t WalkableArea::slab_of(double y) const {
  const double slab = std::floor((y - bottom_) * slabs_per_m_);
  return static_cast<size_t>(std::clamp(slab, 0.0, static_cast<double>(slab_begin_.size() - 2)));
}

bool WalkableArea::contains(const Eigen::Vector2d& point) const {
  if (point.y() < bottom_ || point.y() > top_) return false;
  const size_t slab = slab_of(point.y());
  bool is_inside = false;
  double nearest2 = std::numeric_limits<double>::infinity();
  for (uint32_t i = slab_begin_[slab]; i < slab_begin_[slab + 1]; ++i) {
    const Edge& edge = edges_[i];
    if (i > slab_begin_[slab] && edge.polygon != edges_[i - 1].polygon && is_inside) return true;
    nearest2 = std::min(nearest2, squared_distance(point, edge.from, edge.to));
    if ((edge.from.y() > point.y()) == (edge.to.y() > point.y())) continue;
    const double x = edge.from.x() + (point.y() - edge.from.y()) / (edge.to.y() - edge.from.y()) *
                                         (edge.to.x() - edge.from.x());
    if (point.x() < x) is_inside = !is_inside;
  }
  return is_inside || nearest2 <= kOnEdge_m * kOnEdge_m;
}

}  // namespace throng
