# Spack recipe: copy this folder to packages/pcor of a local package repository. The publisher adds the address of the
# sources and the checksums of releases.
from spack.package import *


class Pcor(CMakePackage):
    """Corrections to the static and dynamic pressure that a research aircraft measures."""

    license("BSD-3-Clause")

    version("main", branch="main")

    variant("shared", default=False, description="Build shared libraries")
    variant("offline", default=True, description="Build the tool and the library of flights, fits and diagnoses")

    depends_on("cxx", type="build")
    depends_on("c", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("udunits")
    depends_on("tomlplusplus")
    depends_on("fmt")
    with when("+offline"):
        depends_on("netcdf-c")
        depends_on("netcdf-cxx4")
        depends_on("nlohmann-json")
        depends_on("boost")
        depends_on("eigen")
        depends_on("ceres-solver")
        depends_on("glog")
        depends_on("nlopt+cxx")
        depends_on("xsimd")
        depends_on("cli11")
        depends_on("cereal")
        depends_on("openssl")

    def cmake_args(self):
        return [
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
            self.define_from_variant("PCOR_OFFLINE", "offline"),
            self.define("PCOR_TESTS", False),
        ]
