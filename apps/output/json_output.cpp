#include "apps/output/json_output.h"

#include "apps/output/text_file.h"
#include "base/say.h"

namespace throng {

void write_json_output(const std::string& file, const std::string& json) {
  if (file.empty()) return;
  if (is_stdout(file))
    show_text(json);
  else
    write_text(file, json);
}

void show_beside_json(const std::string& file, const std::string& table) {
  if (!is_stdout(file)) show_text(table);
}

}  // namespace throng
