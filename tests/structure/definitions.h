// read_definitions finds what a C++ source defines at namespace scope, from its text alone.
#pragma once

#include <string>
#include <vector>

#include "tests/structure/source_tree.h"

namespace throng {

/// A type, function, constant or variable that a file defines at namespace scope.
struct Definition {
  std::string scope;  ///< "throng::one_lane"; "(lanes)" for headers included inside a namespace
  std::string name;   ///< "Sphere", or "overlaps(const Sphere&,const Sphere&)"
  int line = 0;
};

/// Definitions with a name that other files can see: not in unnamed namespaces, not static, not
/// members. Preprocessor branches are all read. Reads what clang-format lays out, not all of C++.
std::vector<Definition> read_definitions(const SourceFile& file);

}  // namespace throng
