# What the library of model files stands on. Read by the build and by an installed package alike.
find_package(PkgConfig REQUIRED)
pkg_check_modules(udunits REQUIRED IMPORTED_TARGET udunits)
find_package(tomlplusplus REQUIRED)
find_package(fmt REQUIRED)
