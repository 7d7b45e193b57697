// No two files define the same type, function or constant in one namespace.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/structure/definitions.h"

namespace throng::one_definition_test {
namespace {

const std::set<std::string_view> kCode = {".cpp", ".h"};

/// Files of which a program links only one.
const std::vector<std::set<std::string>> kAlternatives = {{"analysis/studies/ranks_launched.cpp",
                                                           "analysis/studies/ranks_mpi.cpp",
                                                           "analysis/studies/ranks_none.cpp"}};

std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  for (const Definition& definition : read_definitions({"culling/x.h", text}))
    names.push_back(definition.scope + " " + definition.name);
  return names;
}

/// Program that sees a definition: the product, one folder of tests, or one example.
std::string program_of(const SourceFile& file) {
  if (file.is_test()) return "tests/" + file.folder();
  if (file.folder() == "examples") return file.path;
  return "";
}

bool are_alternatives(const std::set<std::string>& files) {
  return std::any_of(kAlternatives.begin(), kAlternatives.end(), [&](const auto& group) {
    return std::includes(group.begin(), group.end(), files.begin(), files.end());
  });
}

struct Place {
  std::string path, program;
  int line;
};

/// Files among `places` that one program may see together.
std::set<std::string> seen_together(const std::vector<Place>& places) {
  std::set<std::string> files;
  for (const Place& a : places)
    for (const Place& b : places)
      if (a.path != b.path && (a.program.empty() || b.program.empty() || a.program == b.program))
        files.insert({a.path, b.path});
  return files;
}

TEST(Definitions, AreReadWithTheirNamespace) {
  EXPECT_EQ(names_in("namespace a::b { struct alignas(64) S final : T<int> { int x; }; }"),
            std::vector<std::string>{"a::b S"});
  EXPECT_EQ(names_in("namespace a {\n"
                     "enum class E : int { kOne };\n"
                     "template <typename T> class C {};\n"
                     "template <> class C<int> {};\n"
                     "using U = C<int>;\n"
                     "inline constexpr double kHole_s = 1;\n"
                     "constexpr int kRows[] = {1, 2};\n"
                     "}"),
            (std::vector<std::string>{"a E", "a C", "a C<int>", "a U", "a kHole_s", "a kRows"}));
}

TEST(Definitions, DistinguishFunctionsByParameters) {
  EXPECT_EQ(
      names_in(
          "namespace a { F f(const S& s, float x = g(1)) { return {}; }\n"
          "inline F operator+(F a, F b) { return a; } [[nodiscard]] std::pair<int, int> h() {} }"),
      (std::vector<std::string>{"a f(const S&,float)", "a operator+(F,F)", "a h()"}));
}

TEST(Definitions, OmitLocalNames) {
  EXPECT_EQ(names_in("namespace a { namespace { struct S {}; void f() {} } static void g() {}\n"
                     "struct D; void h(); extern int x; void C::m() { struct L {}; }\n"
                     "struct C::I { int i; }; int C::count = 0; // struct Comment {};\n"
                     "const char* const kText = \"struct Text {};\"; }"),
            std::vector<std::string>{"a kText"});
}

TEST(OneDefinition, GivesEachNameOneMeaning) {
  std::map<std::string, std::vector<Place>> places;
  size_t definitions = 0;
  for (const SourceFile& file : read_source_tree()) {
    if (!file.has_extension(kCode)) continue;
    for (const Definition& definition : read_definitions(file)) {
      ++definitions;
      if (definition.name == "main()" || definition.name.starts_with("main(int")) continue;
      places[definition.scope + "::" + definition.name].push_back(
          {file.path, program_of(file), definition.line});
    }
  }
  EXPECT_GT(definitions, 2000u);
  for (const auto& [name, at] : places) {
    const std::set<std::string> files = seen_together(at);
    if (files.empty() || are_alternatives(files)) continue;
    std::string all;
    for (const Place& place : at)
      if (files.contains(place.path)) all += "\n  " + place.path + ":" + std::to_string(place.line);
    ADD_FAILURE() << name << " is defined in several files:" << all;
  }
}

}  // namespace
}  // namespace throng::one_definition_test
