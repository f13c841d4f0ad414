# Dependencies of pcor::offline in addition to model_dependencies.cmake. Used by the build and by the installed package.
find_package(PkgConfig REQUIRED)
pkg_check_modules(netcdf_cxx4 REQUIRED IMPORTED_TARGET netcdf-cxx4)
pkg_check_modules(netcdf REQUIRED IMPORTED_TARGET netcdf)
find_package(nlohmann_json REQUIRED)
find_package(cereal REQUIRED) # messages between processes
find_package(Boost REQUIRED) # headers only: Boost.Math (distributions), Boost.Random
find_package(OpenSSL REQUIRED) # libcrypto: SHA-256 of the inputs of an output file
find_package(Eigen3 REQUIRED)
find_package(Ceres REQUIRED)
find_package(glog REQUIRED) # log messages of Ceres
pkg_check_modules(nlopt REQUIRED IMPORTED_TARGET nlopt)
find_package(Threads REQUIRED)
