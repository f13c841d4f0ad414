# Dependencies of pcor::model. Used by the build and by the installed package.
find_package(PkgConfig REQUIRED)
pkg_check_modules(udunits REQUIRED IMPORTED_TARGET udunits)
find_package(tomlplusplus REQUIRED)
find_package(fmt REQUIRED)
