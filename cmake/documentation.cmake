# Documentation site: cmake --build build/release --target documentation writes build/release/html from the documents, the
# reference pages printed by the tool, and the public headers. Needs Doxygen.
find_package(Doxygen QUIET)
find_package(Python3 3.9 QUIET COMPONENTS Interpreter)
if(DOXYGEN_FOUND AND Python3_FOUND AND TARGET pcor_tool)
  set(reference ${PROJECT_BINARY_DIR}/reference)
  add_custom_command(OUTPUT ${reference}/options.md ${reference}/effects.md ${reference}/output-variables.md ${reference}/json.md
    COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/tools/reference_pages $<TARGET_FILE:pcor_tool> ${reference}
    DEPENDS pcor_tool ${PROJECT_SOURCE_DIR}/tools/reference_pages VERBATIM)

  # With the Python package: executed notebooks. Needs nbconvert. PCOR_FLIGHTS names the folder of the real flight.
  set(notebooks)
  if(TARGET pcor_python)
    find_package(Python 3.9 REQUIRED COMPONENTS Interpreter)
    foreach(notebook real_flight own_effect)
      add_custom_command(OUTPUT ${reference}/${notebook}.html
        COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_BINARY_DIR}/python Python::Interpreter -m nbconvert --log-level WARN
          --execute --to html --output-dir ${reference} ${PROJECT_SOURCE_DIR}/python/notebooks/${notebook}.ipynb
        DEPENDS pcor_python ${PROJECT_SOURCE_DIR}/python/notebooks/${notebook}.ipynb VERBATIM)
      list(APPEND notebooks ${reference}/${notebook}.html)
    endforeach()
    file(WRITE ${reference}/notebooks.md "# Notebooks\n\n- <a href=\"real_flight.html\">From a real flight to corrected pressures</a>\n\
- <a href=\"own_effect.html\">A new effect</a>\n")
    set(DOXYGEN_HTML_EXTRA_FILES ${notebooks})
  endif()
  add_custom_target(reference_pages DEPENDS ${reference}/options.md ${notebooks})

  set(DOXYGEN_USE_MDFILE_AS_MAINPAGE ${PROJECT_SOURCE_DIR}/README.md)
  set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR}/include)
  set(DOXYGEN_IMAGE_PATH ${PROJECT_SOURCE_DIR}/data/example)
  set(DOXYGEN_EXTRACT_ALL YES)
  set(DOXYGEN_GENERATE_TREEVIEW YES)
  set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
  set(DOXYGEN_QUIET YES)
  set(DOXYGEN_TOC_INCLUDE_HEADINGS 3)
  set(DOXYGEN_WARN_IF_INCOMPLETE_DOC NO)
  set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
  doxygen_add_docs(documentation include README.md CONTRIBUTING.md CHANGELOG.md docs data/models data/aircraft data/scenarios
    data/reference tests/hidden/results.md ${reference})
  add_dependencies(documentation reference_pages)

  # The same without the pages that programs write, which takes seconds.
  if(PCOR_TESTS)
    file(MAKE_DIRECTORY ${reference})
    file(READ ${PROJECT_BINARY_DIR}/Doxyfile.documentation doxyfile)
    file(WRITE ${PROJECT_BINARY_DIR}/Doxyfile.warnings
      "${doxyfile}HTML_EXTRA_FILES =\nOUTPUT_DIRECTORY = ${PROJECT_BINARY_DIR}/documentation_warnings\n")
    add_test(NAME documentation.warnings COMMAND Doxygen::doxygen ${PROJECT_BINARY_DIR}/Doxyfile.warnings
      WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  endif()
endif()
