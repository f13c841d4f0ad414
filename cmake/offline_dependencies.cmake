# Dependencies of the offline library in addition to model_dependencies.cmake. Used by the build and by the
# installed package.
find_package(PkgConfig REQUIRED)
pkg_check_modules(netcdf_cxx4 REQUIRED IMPORTED_TARGET netcdf-cxx4)
pkg_check_modules(netcdf REQUIRED IMPORTED_TARGET netcdf)
find_package(nlohmann_json REQUIRED)
find_package(cereal REQUIRED) # what processes of a team send each other
find_package(Boost REQUIRED) # headers: the distributions of Boost.Math, the random numbers of Boost.Random
find_package(OpenSSL REQUIRED) # libcrypto: the SHA-256 of what an output was made of
find_package(Eigen3 REQUIRED)
find_package(Ceres REQUIRED)
find_package(glog REQUIRED) # in which Ceres writes
pkg_check_modules(nlopt REQUIRED IMPORTED_TARGET nlopt)
find_package(Threads REQUIRED)
