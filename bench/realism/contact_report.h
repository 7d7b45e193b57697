// The tables of `realism contacts`.
// One rule: what there is nothing of is a dash, never 0.
#pragma once

#include <optional>
#include <string>

#include "bench/realism/contact_account.h"

namespace throng::realism {

struct AccountOf {
  std::string name;
  ContactSums sums;
};

/// With a second one, each figure is followed by its own: before and after.
std::string contact_report(const AccountOf& before, const AccountOf* after, bool with_parts);

}  // namespace throng::realism
