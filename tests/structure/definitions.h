// read_definitions finds what a C++ source defines at namespace scope, from its text alone.
#pragma once

#include <string>
#include <vector>

#include "tests/structure/source_tree.h"

namespace throng {

/// A type, function, constant or variable that a file defines at namespace scope.
struct Definition {
  std::string scope;  ///< "throng::scalar_lanes"; "(lanes)" for headers included inside a namespace
  std::string name;   ///< "Sphere", or "overlaps(const Sphere&,const Sphere&)"
  int line = 0;
};

/// Returns definitions visible to other files: not in unnamed namespaces, not static, not members.
/// Reads all preprocessor branches. Expects the layout of clang-format, not all of C++.
std::vector<Definition> read_definitions(const SourceFile& file);

}  // namespace throng
