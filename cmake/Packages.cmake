# `cpack`: packages for Debian 12 - throng (the command), libthrong-dev, and python3-throng if the Python module
# is built. scripts/package.sh makes these and an archive for other systems.
set(documents ${CMAKE_INSTALL_DATADIR}/doc)
install(FILES ${package}/copyright DESTINATION ${documents}/throng COMPONENT throng)
install(CODE "execute_process(COMMAND gzip -9n -c ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    OUTPUT_FILE ${made}/CHANGELOG.md.gz COMMAND_ERROR_IS_FATAL ANY)
  file(INSTALL DESTINATION \${CMAKE_INSTALL_PREFIX}/${documents}/throng TYPE FILE FILES ${made}/CHANGELOG.md.gz)"
  COMPONENT throng)

get_cmake_property(installed COMPONENTS)
set(CPACK_COMPONENTS_ALL throng dev)
foreach(component throng dev python)
  string(TOUPPER ${component} COMPONENT)
  set(CPACK_DEBIAN_${COMPONENT}_FILE_NAME DEB-DEFAULT)
endforeach()
install(FILES ${package}/copyright DESTINATION ${documents}/libthrong-dev COMPONENT dev)
if(python IN_LIST installed)
  list(APPEND CPACK_COMPONENTS_ALL python)
  install(FILES ${package}/copyright DESTINATION ${documents}/python3-throng COMPONENT python)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME throng)
set(CPACK_PACKAGE_CONTACT "The Throng authors <throng@localhost>")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# The first line of every description is the project's.
set(about "Throng simulates crowds of people and robots, made of URDFs and triangle
meshes, and detects every contact between their body parts. It never misses a
contact. Contacts are published over LCM and written to a log.")
set(CPACK_DEBIAN_THRONG_PACKAGE_NAME throng)
set(CPACK_DEBIAN_THRONG_PACKAGE_SECTION science)
set(CPACK_DEBIAN_THRONG_DESCRIPTION "${about}")
set(CPACK_DEBIAN_THRONG_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_THRONG_PACKAGE_SUGGESTS gnuplot-nox)

# culling needs the packages under Depends; other libraries need those under Recommends. find_package(throng)
# and pkg-config name missing ones.
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libthrong-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_DESCRIPTION "${about}

This package has the static libraries and headers, for CMake's
find_package(throng) and for pkg-config.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libeigen3-dev, libfmt-dev, libhwy-dev, libtbb-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "throng (= ${PROJECT_VERSION}-1), pkg-config, liburdfdom-dev, \
liborocos-kdl-dev, libassimp-dev, libyaml-cpp-dev, libpng-dev, libsqlite3-dev, zlib1g-dev, \
libhdf5-dev, librecast-dev, liblcm-dev, libglib2.0-dev, libzstd-dev")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-throng)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "${about}

This package has the Python module.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy, throng (= ${PROJECT_VERSION}-1)")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-pandas)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${package}/python/postinst ${package}/python/prerm)
include(CPack)
