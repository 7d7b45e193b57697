#include "avatars/models/loft.h"

#include <cassert>
#include <cmath>

namespace throng {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kGrid_m = 1e-5;

void close_end(Mesh& mesh, int ring_start, int segments, int pole, bool first) {
  const auto add = [&](int a, int b, int c) {
    if (first)
      mesh.triangles.emplace_back(a, c, b);
    else
      mesh.triangles.emplace_back(a, b, c);
  };
  if (pole >= 0) {
    for (int k = 0; k < segments; ++k) add(ring_start + k, ring_start + (k + 1) % segments, pole);
    return;
  }
  // Without a pole: strips from side to side, to keep the triangles from meeting in one corner.
  for (int low = 0, high = segments - 1; low + 1 < high;) {
    add(ring_start + low, ring_start + low + 1, ring_start + high);
    ++low;
    if (low + 1 < high) {
      add(ring_start + low, ring_start + high - 1, ring_start + high);
      --high;
    }
  }
}

void add_strip(Mesh& mesh, int low_start, int low_size, int high_start, int high_size) {
  const auto low = [&](int k) { return low_start + k % low_size; };
  const auto high = [&](int k) { return high_start + k % high_size; };
  if (low_size == high_size) {
    for (int k = 0; k < low_size; ++k) {
      mesh.triangles.emplace_back(low(k), low(k + 1), high(k + 1));
      mesh.triangles.emplace_back(low(k), high(k + 1), high(k));
    }
    return;
  }
  // Walks around both rings, advancing on the one whose next edge has its middle earlier.
  for (int l = 0, h = 0; l < low_size || h < high_size;) {
    if ((2 * l + 1) * high_size < (2 * h + 1) * low_size) {
      mesh.triangles.emplace_back(low(l), low(l + 1), high(h));
      ++l;
    } else {
      mesh.triangles.emplace_back(low(l), high(h + 1), high(h));
      ++h;
    }
  }
}

double blend(double Section::*column, std::span<const Section> table, size_t i, double height) {
  const auto slope = [&](size_t k) {
    return (table[k + 1].*column - table[k].*column) / (table[k + 1].height - table[k].height);
  };
  // Fritsch-Butland: the weighted harmonic mean of the neighbouring slopes, 0 at an extremum.
  const auto tangent = [&](size_t k) {
    if (k == 0) return slope(0);
    if (k + 1 == table.size()) return slope(k - 1);
    const double before = slope(k - 1);
    const double after = slope(k);
    if (before * after <= 0) return 0.0;
    const double h0 = table[k].height - table[k - 1].height;
    const double h1 = table[k + 1].height - table[k].height;
    return 3 * (h0 + h1) / ((2 * h1 + h0) / before + (h1 + 2 * h0) / after);
  };
  const double h = table[i + 1].height - table[i].height;
  const double t = (height - table[i].height) / h;
  const double u = 1 - t;
  return table[i].*column * (u * u * (1 + 2 * t)) + table[i + 1].*column * (t * t * (3 - 2 * t)) +
         h * (tangent(i) * (t * u * u) - tangent(i + 1) * (t * t * u));
}

Section scaled(Section s, double factor) {
  s.front *= factor;
  s.back *= factor;
  s.left *= factor;
  s.right *= factor;
  return s;
}

}  // namespace

Eigen::Vector2d on_circle(double turns) {
  assert(turns >= -0.5 && turns <= 0.5);
  // Taylor series of the half angle, below pi/2, then doubled: exactly symmetric.
  const double a = kPi * turns;
  double sine = 0;
  double cosine = 0;
  double term = 1;
  for (int n = 0; n < 28; n += 2) {
    cosine += term;
    sine += term * a / (n + 1);
    term *= -a * a / ((n + 1) * (n + 2));
  }
  return {cosine * cosine - sine * sine, 2 * sine * cosine};
}

Section section_at(std::span<const Section> table, double height) {
  assert(table.size() >= 2);
  const bool rising = table.back().height > table.front().height;
  size_t i = 0;
  while (i + 2 < table.size() &&
         (rising ? height > table[i + 1].height : height < table[i + 1].height))
    ++i;
  Section out{};
  out.height = height;
  for (double Section::*column : {&Section::x, &Section::y, &Section::front, &Section::back,
                                  &Section::left, &Section::right, &Section::square})
    out.*column = blend(column, table, i, height);
  return out;
}

Ring ring_of(const Section& section, int segments, double crowding) {
  Ring ring;
  for (int k = 0; k < segments; ++k) {
    // Counting the far half backwards makes the two halves mirror images to the bit.
    const double turns = (2 * k > segments ? k - segments : k) / static_cast<double>(segments);
    const double drawn = turns - crowding * on_circle(turns).y() / (2 * kPi);
    const Eigen::Vector2d unit = on_circle(2 * k == segments ? 0.5 : drawn);
    const double c2 = unit.x() * unit.x();
    const double s2 = unit.y() * unit.y();
    const double r = 1 + section.square * (1 / std::sqrt(std::sqrt(c2 * c2 + s2 * s2)) - 1);
    ring.emplace_back(section.x + (unit.x() > 0 ? section.front : section.back) * unit.x() * r,
                      section.y + (unit.y() > 0 ? section.left : section.right) * unit.y() * r,
                      section.height);
  }
  return ring;
}

std::vector<Ring> rings_of(const Loft& loft) {
  const double first = loft.table.front().height;
  const double last = loft.table.back().height;
  const double forward = last > first ? 1 : -1;
  const int body = loft.rings - loft.first_cap_rings - loft.last_cap_rings;
  std::vector<Ring> rings;
  const auto cap = [&](const Section& end, int i, int count, double depth) {
    const Eigen::Vector2d unit =
        on_circle(0.25 * i / (count + 1));  // 0: the pole, 1/4: the end row
    Section s = scaled(end, unit.y());
    s.height += depth * unit.x();
    rings.push_back(ring_of(s, loft.segments));
  };
  for (int i = 1; i <= loft.first_cap_rings; ++i)
    cap(loft.table.front(), i, loft.first_cap_rings, -forward * loft.first_cap_m);
  for (int i = 0; i < body; ++i)
    rings.push_back(
        ring_of(section_at(loft.table, first + (last - first) * i / (body - 1)), loft.segments));
  for (int i = loft.last_cap_rings; i >= 1; --i)
    cap(loft.table.back(), i, loft.last_cap_rings, forward * loft.last_cap_m);
  return rings;
}

Mesh tube(std::span<const Ring> rings, const Poles& poles) {
  Mesh mesh;
  std::vector<int> starts;  // index of each ring's first vertex
  for (const Ring& ring : rings) {
    starts.push_back(static_cast<int>(mesh.vertices.size()));
    for (const Eigen::Vector3d& point : ring) mesh.vertices.push_back(rounded(point));
  }
  int first_pole = -1;
  int last_pole = -1;
  if (poles.first != nullptr) {
    first_pole = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back(rounded(*poles.first));
  }
  if (poles.last != nullptr) {
    last_pole = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back(rounded(*poles.last));
  }
  const auto size_of = [&](size_t r) { return static_cast<int>(rings[r].size()); };
  close_end(mesh, 0, size_of(0), first_pole, true);
  for (size_t r = 0; r + 1 < rings.size(); ++r)
    add_strip(mesh, starts[r], size_of(r), starts[r + 1], size_of(r + 1));
  close_end(mesh, starts.back(), size_of(rings.size() - 1), last_pole, false);
  orient_outwards(mesh);
  return mesh;
}

Mesh lofted(const Loft& loft) {
  const Section& a = loft.table.front();
  const Section& b = loft.table.back();
  const double forward = b.height > a.height ? 1 : -1;
  const Eigen::Vector3d first(a.x, a.y, a.height - forward * loft.first_cap_m);
  const Eigen::Vector3d last(b.x, b.y, b.height + forward * loft.last_cap_m);
  return tube(rings_of(loft), {&first, &last});
}

void orient_outwards(Mesh& mesh) {
  if (signed_volume_m3(mesh) >= 0) return;
  for (Eigen::Vector3i& t : mesh.triangles) std::swap(t[1], t[2]);
}

Mesh mirrored(const Mesh& mesh) {
  Mesh out = mesh;
  for (Eigen::Vector3f& v : out.vertices) v.y() = v.y() == 0 ? 0.0F : -v.y();
  for (Eigen::Vector3i& t : out.triangles) std::swap(t[1], t[2]);
  return out;
}

Mesh relative_to(const Mesh& mesh, const Eigen::Vector3d& origin) {
  Mesh out = mesh;
  for (Eigen::Vector3f& v : out.vertices) v = rounded(v.cast<double>() - origin);
  return out;
}

Eigen::Vector3f rounded(const Eigen::Vector3d& point) {
  Eigen::Vector3f out;
  for (int i = 0; i < 3; ++i) {
    const double steps = std::floor(point[i] / kGrid_m + 0.5);
    out[i] = steps == 0 ? 0.0F : static_cast<float>(steps / 1e5);
  }
  return out;
}

}  // namespace throng
