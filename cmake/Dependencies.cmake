# All libraries that Throng uses; only those of enabled options are looked for. All are Debian packages,
# which scripts/setup.sh installs.
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # projects that add Throng link with them as well
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET GLOBAL libhwy)

if(THRONG_KINEMATICS)
  pkg_check_modules(URDFDOM REQUIRED IMPORTED_TARGET GLOBAL urdfdom urdfdom_headers)
  pkg_check_modules(KDL REQUIRED IMPORTED_TARGET GLOBAL orocos-kdl)
endif()

if(THRONG_SCENES)
  pkg_check_modules(ASSIMP REQUIRED IMPORTED_TARGET GLOBAL assimp)
  find_package(yaml-cpp REQUIRED)
  find_package(nlohmann_json REQUIRED)  # floor plans: JSON and pictures
  find_package(PNG REQUIRED)
  find_package(SQLite3 REQUIRED)  # trajectories
  find_package(ZLIB REQUIRED)     # compressed recordings
  pkg_search_module(HDF5 REQUIRED IMPORTED_TARGET GLOBAL hdf5-serial hdf5)  # recordings
  if(THRONG_MPI)
    set(MPI_CXX_SKIP_MPICXX ON)
    find_package(MPI COMPONENTS CXX)  # optional: ranks of a study
  endif()
  find_package(Boost REQUIRED)    # headers: polygons of the walkable area
  list(APPEND CMAKE_MODULE_PATH ${PROJECT_SOURCE_DIR}/cmake/package)
  find_package(Recast REQUIRED)   # navigation meshes
  list(POP_BACK CMAKE_MODULE_PATH)
endif()

if(THRONG_LCM)
  pkg_check_modules(LCM REQUIRED IMPORTED_TARGET GLOBAL lcm)
  pkg_check_modules(ZSTD IMPORTED_TARGET GLOBAL libzstd)  # optional: compressed MCAP files
  find_program(LCM_GEN lcm-gen REQUIRED)
endif()

if(THRONG_VIEWER)
  pkg_check_modules(GLIB REQUIRED IMPORTED_TARGET GLOBAL glib-2.0)
  pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET GLOBAL libwebp libwebpmux)
  find_program(NODE node REQUIRED)
  find_program(NPM npm REQUIRED)
endif()

# The Python module, for Debian's Python; PYTHON_EXECUTABLE selects another one.
if(THRONG_VIEWER)
  find_program(PYTHON_EXECUTABLE python3 PATHS /usr/bin NO_DEFAULT_PATH)
  set(Python3_EXECUTABLE ${PYTHON_EXECUTABLE})
  find_package(Python3 3.9 QUIET COMPONENTS Interpreter Development.Module NumPy)
  find_package(pybind11 2.10 QUIET CONFIG)
  set(has_python OFF)
  if(Python3_FOUND AND pybind11_FOUND)
    set(has_python ON)
  endif()
  option(THRONG_PYTHON "Build the Python module `throng`" ${has_python})
  if(THRONG_PYTHON AND NOT has_python)
    message(FATAL_ERROR "THRONG_PYTHON: expected pybind11 2.10, and Python 3.9 with numpy and its headers, found "
                        "them incomplete; install pybind11-dev, python3-dev and python3-numpy")
  endif()
endif()

if(THRONG_APPS)
  find_package(CLI11 REQUIRED)
endif()

if(THRONG_TESTS)
  find_package(GTest REQUIRED)
endif()

if(THRONG_TESTS OR THRONG_BENCH)
  find_package(fcl REQUIRED)  # test oracle and benchmark
endif()
