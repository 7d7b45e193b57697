# Recast::Recast and Recast::Detour: navigation meshes. Debian's package has neither CMake nor pkg-config files.
# Throng's build and its installed package both read this file.
find_path(RECAST_INCLUDE_DIR Recast.h PATH_SUFFIXES recastnavigation)
find_library(RECAST_LIBRARY Recast)
find_library(DETOUR_LIBRARY Detour)
mark_as_advanced(RECAST_INCLUDE_DIR RECAST_LIBRARY DETOUR_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Recast REQUIRED_VARS RECAST_LIBRARY DETOUR_LIBRARY RECAST_INCLUDE_DIR)
if(Recast_FOUND)
  foreach(name Recast Detour)
    string(TOUPPER ${name} NAME)
    if(NOT TARGET Recast::${name})
      add_library(Recast::${name} UNKNOWN IMPORTED)
      set_target_properties(Recast::${name} PROPERTIES
        IMPORTED_LOCATION "${${NAME}_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${RECAST_INCLUDE_DIR}")
      if(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL)
        set_target_properties(Recast::${name} PROPERTIES IMPORTED_GLOBAL TRUE)
      endif()
    endif()
  endforeach()
endif()
