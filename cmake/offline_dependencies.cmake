# What the offline library stands on. Read by the build and by an installed package alike.
find_package(PkgConfig REQUIRED)
pkg_check_modules(netcdf_cxx4 REQUIRED IMPORTED_TARGET netcdf-cxx4)
pkg_check_modules(netcdf REQUIRED IMPORTED_TARGET netcdf)
pkg_check_modules(udunits REQUIRED IMPORTED_TARGET udunits)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(fmt REQUIRED)
