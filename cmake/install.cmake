# Installation. Each library has its own export set, so that find_package does not require netCDF for a program on the
# aircraft, which uses pcor::realtime only.
include(CMakePackageConfigHelpers)
set(pcor_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pcor)

install(TARGETS pcor_realtime EXPORT pcor-realtime)
install(EXPORT pcor-realtime NAMESPACE pcor:: DESTINATION ${pcor_config_dir})

if(PCOR_MODEL)
  install(TARGETS pcor_model EXPORT pcor-model
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT pcor-model NAMESPACE pcor:: DESTINATION ${pcor_config_dir})
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/model_dependencies.cmake DESTINATION ${pcor_config_dir})
endif()

if(PCOR_OFFLINE)
  install(TARGETS pcor_offline EXPORT pcor-offline
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT pcor-offline NAMESPACE pcor:: DESTINATION ${pcor_config_dir})
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/offline_dependencies.cmake DESTINATION ${pcor_config_dir})
endif()

if(TARGET pcor_mpi_tool)
  install(TARGETS pcor_mpi_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET pcor_tool)
  install(TARGETS pcor_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(PROGRAMS ${PROJECT_SOURCE_DIR}/tools/pcor-figures DESTINATION ${CMAKE_INSTALL_BINDIR})
  if(NOT CMAKE_CROSSCOMPILING)
    install(DIRECTORY ${pcor_shell_files}/bash-completion DESTINATION ${CMAKE_INSTALL_DATADIR})
    install(DIRECTORY ${pcor_shell_files}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
  endif()
endif()

# Headers of modules that are not built are excluded: their functions could not be linked.
set(pcor_headers ${pcor_realtime_modules})
if(PCOR_MODEL)
  list(APPEND pcor_headers ${pcor_model_modules})
endif()
if(PCOR_OFFLINE)
  list(APPEND pcor_headers ${pcor_offline_modules})
endif()
foreach(module IN LISTS pcor_headers)
  if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/include/pcor/${module})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/pcor/${module}
            DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pcor FILES_MATCHING PATTERN "*.hpp")
  endif()
endforeach()
foreach(data models aircraft scenarios)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/${data} DESTINATION ${CMAKE_INSTALL_DATADIR}/pcor)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR} USE_SOURCE_PERMISSIONS)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
              ${PROJECT_SOURCE_DIR}/CONTRIBUTING.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
# Pages and pictures linked from the documents; the documentation site if it was built.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data DESTINATION ${CMAKE_INSTALL_DOCDIR}
        FILES_MATCHING PATTERN "*.md" PATTERN "*.svg")
install(DIRECTORY ${PROJECT_BINARY_DIR}/html DESTINATION ${CMAKE_INSTALL_DOCDIR} OPTIONAL)

# pkg-config files for programs not built with CMake. A static build lists its dependencies as public, so that the option
# --static is not needed.
if(BUILD_SHARED_LIBS)
  set(pcor_private_requires "\nRequires.private:")
  set(pcor_private_libs "\nLibs.private:")
endif()
set(pcor_pkg_config pcor-realtime)
if(PCOR_MODEL)
  list(APPEND pcor_pkg_config pcor-model)
endif()
if(PCOR_OFFLINE)
  list(APPEND pcor_pkg_config pcor-offline)
endif()
foreach(name IN LISTS pcor_pkg_config)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/packaging/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/pcorConfig.cmake.in ${PROJECT_BINARY_DIR}/pcorConfig.cmake
  INSTALL_DESTINATION ${pcor_config_dir}
  PATH_VARS CMAKE_INSTALL_DATADIR)
# Before 1.0 a minor version may be incompatible, so 0.3 does not satisfy a request for 0.2.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pcorConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pcorConfig.cmake ${PROJECT_BINARY_DIR}/pcorConfigVersion.cmake
        DESTINATION ${pcor_config_dir})
