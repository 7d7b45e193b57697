# Writes OUT, which defines gait_sources: a hash of FILES, the inputs of a tabulated gait.
set(all)
foreach(file IN LISTS FILES)
  file(SHA256 ${file} hash)
  string(APPEND all ${hash})
endforeach()
string(SHA256 hash "${all}")
file(WRITE ${OUT} "namespace throng {
extern const char* const gait_sources;
const char* const gait_sources = \"${hash}\";
}  // namespace throng
")
