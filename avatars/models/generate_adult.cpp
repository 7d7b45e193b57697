// throng_generate_adult FOLDER: writes adult.urdf and its 15 .tri files.
#include <exception>

#include "avatars/models/adult_body.h"
#include "base/console.h"

int main(int count, char** arguments) {
  if (count != 2) {
    throng::print_message("usage: throng_generate_adult FOLDER\n");
    return 2;
  }
  try {
    throng::write_adult(arguments[1]);
  } catch (const std::exception& error) {
    throng::print_message("{}\n", error.what());
    return 3;
  }
  return 0;
}
