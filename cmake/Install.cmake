# `cmake --install`: the command and its data (component `throng`), the libraries for find_package(throng)
# and pkg-config (`dev`), and the Python module (`python`). Installed files can be moved: none names the
# build folder or the prefix.
include(CMakePackageConfigHelpers)
set(THRONG_DATADIR ${CMAKE_INSTALL_DATADIR}/throng)
set(THRONG_CMAKEDIR ${CMAKE_INSTALL_LIBDIR}/cmake/throng)
# Folder of Python modules, as in Debian's packages.
set(THRONG_INSTALL_PYTHONDIR lib/python3/dist-packages CACHE STRING "Folder of the Python module, below the prefix")
set(package ${PROJECT_SOURCE_DIR}/cmake/package)
set(made ${PROJECT_BINARY_DIR}/package)

# The command, and the data in share/throng for it and for every program on the libraries.
if(THRONG_APPS)
  install(TARGETS throng RUNTIME COMPONENT throng)
  # Its manual, if help2man is installed.
  install(CODE "execute_process(COMMAND bash ${PROJECT_SOURCE_DIR}/scripts/manual.sh
      $<TARGET_FILE:throng> ${made}/man COMMAND_ERROR_IS_FATAL ANY)
    if(EXISTS ${made}/man/throng.1.gz)
      file(GLOB pages ${made}/man/*.1.gz)
      file(INSTALL DESTINATION \${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1 TYPE FILE FILES \${pages})
    endif()" COMPONENT throng)
endif()
if(THRONG_SCENES)
  install(DIRECTORY avatars/models/adult DESTINATION ${THRONG_DATADIR}/avatars/models COMPONENT throng)
  install(DIRECTORY scenes/bundled DESTINATION ${THRONG_DATADIR}/scenes COMPONENT throng)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/lib/throng/gaits DESTINATION lib/throng COMPONENT throng)
  install(FILES scenes/scene.schema.json DESTINATION ${THRONG_DATADIR}/scenes COMPONENT throng)
endif()
if(THRONG_LCM)
  list(TRANSFORM THRONG_LCM_TYPES REPLACE "(.+)" "lcmtypes/\\1.lcm" OUTPUT_VARIABLE lcm_files)
  install(FILES ${lcm_files} DESTINATION ${THRONG_DATADIR}/lcmtypes COMPONENT dev)
endif()

# The Python module, which finds the data as programs do.
if(TARGET throng_core)
  install(TARGETS throng_core LIBRARY DESTINATION ${THRONG_INSTALL_PYTHONDIR}/throng COMPONENT python)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/python/throng DESTINATION ${THRONG_INSTALL_PYTHONDIR} COMPONENT python
    FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)
endif()

# throng_install(NAME [HEADERS FILE...] [REQUIRES MODULE...] [LIBS FLAG...]): throng::NAME with its public
# headers, as a component of find_package(throng) and as throng-NAME of pkg-config. REQUIRES and LIBS are for
# pkg-config; CMake derives them.
set(THRONG_COMPONENTS)
function(throng_install name)
  cmake_parse_arguments(I "" "" "HEADERS;REQUIRES;LIBS" ${ARGN})
  set(targets throng_${name})
  set(PC_CFLAGS "-I\${includedir}/throng")
  get_target_property(type throng_${name} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    list(PREPEND I_LIBS -lthrong_${name})
  endif()
  if(name STREQUAL "base")
    list(APPEND targets throng_options)
    set_target_properties(throng_options PROPERTIES EXPORT_NAME options)
    string(APPEND PC_CFLAGS " -ffp-contract=off -pthread")
  elseif(name STREQUAL "lcm_types")
    set(PC_CFLAGS "-I\${includedir}")
  endif()
  set_target_properties(throng_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${targets} EXPORT throng-${name} ARCHIVE COMPONENT dev)
  install(EXPORT throng-${name} FILE throng-${name}-targets.cmake NAMESPACE throng::
    DESTINATION ${THRONG_CMAKEDIR} COMPONENT dev)

  set(NAME ${name})
  file(RELATIVE_PATH PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" PC_PREFIX "${PC_PREFIX}")
  list(JOIN I_REQUIRES ", " PC_REQUIRES)
  list(JOIN I_LIBS " " PC_LIBS)
  if(PC_LIBS)
    string(PREPEND PC_LIBS "-L\${libdir} ")
  endif()
  configure_file(${package}/throng.pc.in ${made}/throng-${name}.pc @ONLY)
  install(FILES ${made}/throng-${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)

  set_property(GLOBAL APPEND PROPERTY THRONG_PUBLIC_HEADERS ${I_HEADERS})
  set(THRONG_COMPONENTS ${THRONG_COMPONENTS} ${name} PARENT_SCOPE)
endfunction()

throng_install(base
  HEADERS base/errors.h base/pose.h base/version.h
  REQUIRES eigen3 fmt tbb LIBS -lhwy)
throng_install(culling HEADERS culling/culling.h REQUIRES throng-base)
if(THRONG_KINEMATICS)
  throng_install(kinematics
    HEADERS kinematics/kinematics.h REQUIRES throng-base urdfdom orocos-kdl)
endif()
if(THRONG_SCENES)
  throng_install(avatars HEADERS avatars/avatars.h REQUIRES throng-kinematics throng-culling assimp)
  throng_install(geometry REQUIRES throng-base)
  throng_install(recordings REQUIRES throng-culling throng-geometry sqlite3 zlib ${HDF5_MODULE_NAME})
  throng_install(crowd REQUIRES throng-avatars throng-geometry LIBS -lDetour -lRecast)
  throng_install(scenes HEADERS scenes/scenes.h REQUIRES throng-crowd throng-recordings yaml-cpp libpng)
endif()
if(TARGET throng_workbench)
  throng_install(workbench HEADERS bench/workbench/workbench.h REQUIRES throng-scenes)
endif()
if(THRONG_LCM)
  throng_install(lcm_types REQUIRES lcm)
  set(THRONG_ZSTD_MODULE)
  if(ZSTD_FOUND)
    set(THRONG_ZSTD_MODULE ZSTD:libzstd:libzstd-dev)
    set(zstd libzstd)
  endif()
  throng_install(lcm_io HEADERS lcm_io/lcm_io.h REQUIRES throng-scenes throng-lcm_types ${zstd})
  install(DIRECTORY ${PROJECT_BINARY_DIR}/lcmtypes/generated/throng/
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/throng COMPONENT dev FILES_MATCHING PATTERN "*.hpp")
endif()
get_property(headers GLOBAL PROPERTY THRONG_PUBLIC_HEADERS)
install(CODE "set(SOURCE \"${PROJECT_SOURCE_DIR}\")
  set(DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/throng\")
  set(HEADERS ${headers})
  include(\"${package}/install_headers.cmake\")" COMPONENT dev)

list(JOIN THRONG_COMPONENTS ", " THRONG_COMPONENTS_TEXT)
list(JOIN THRONG_COMPONENTS " " THRONG_COMPONENTS)
configure_package_config_file(${package}/throng-config.cmake.in ${made}/throng-config.cmake
  INSTALL_DESTINATION ${THRONG_CMAKEDIR} PATH_VARS THRONG_DATADIR)
# Before 1.0 a minor version may change interfaces, see docs/stability.md.
write_basic_package_version_file(${made}/throng-config-version.cmake COMPATIBILITY SameMinorVersion)
set(config_files ${made}/throng-config.cmake ${made}/throng-config-version.cmake ${package}/data_place.cpp.in)
if(THRONG_SCENES)
  list(APPEND config_files ${package}/FindRecast.cmake)
endif()
install(FILES ${config_files} DESTINATION ${THRONG_CMAKEDIR} COMPONENT dev)

include(cmake/Packages.cmake)
