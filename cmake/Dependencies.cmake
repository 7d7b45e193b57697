# Every library Throng uses, in one place. All are Debian packages; scripts/setup.sh installs them.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
find_package(GTest REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(URDFDOM REQUIRED IMPORTED_TARGET urdfdom urdfdom_headers)
pkg_check_modules(KDL REQUIRED IMPORTED_TARGET orocos-kdl)
pkg_check_modules(LCM REQUIRED IMPORTED_TARGET lcm)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)
pkg_check_modules(ASSIMP REQUIRED IMPORTED_TARGET assimp)
find_package(fcl REQUIRED)
find_package(SQLite3 REQUIRED)  # trajectories
find_package(Boost REQUIRED)    # headers: the area that people can walk on, as polygons
