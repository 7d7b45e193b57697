#include "scenes/import/plan_json.h"

#include <algorithm>

#include "base/errors.h"
#include "base/text.h"

namespace throng {

PlanJson parse_plan_json(const std::string& text, const std::string& file) {
  try {
    return PlanJson::parse(text);
  } catch (const PlanJson::parse_error& error) {
    const auto end = text.begin() + static_cast<ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
    throw InputError(at_line(file, line), "JSON",
                     error.byte > text.size()
                         ? "the end of the file: it is cut short; export it again"
                         : "a mistake here; export it again");
  } catch (const PlanJson::exception&) {
    throw InputError(file, "JSON", "a number that is too large; export it again");
  }
}

std::string described_json(const PlanJson& value) {
  constexpr size_t kMaxBytes = 60;
  if (value.is_object()) return "an object";
  if (value.is_array()) return value.empty() ? "an empty list" : "a list";
  return in_quotes(
      value.dump(-1, ' ', false, PlanJson::error_handler_t::replace).substr(0, kMaxBytes));
}

}  // namespace throng
