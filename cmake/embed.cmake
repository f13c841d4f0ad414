# Embeds text files in a C++ source file.
#
#   pcor_embed(TARGET OUTPUT NAMESPACE NAME FILE... [NAME FILE...]...)
#
# Adds the source OUTPUT to TARGET. It defines `extern const std::string_view NAME` in NAMESPACE: the concatenation of the
# FILEs. An argument with a dot is a file, relative to the current source directory; other arguments are names.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(pcor_embed_script ${CMAKE_CURRENT_LIST_FILE})

  function(pcor_embed target output namespace)
    set(files ${ARGN})
    list(FILTER files INCLUDE REGEX "[.]")
    add_custom_command(OUTPUT ${output}
      COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DNAMESPACE=${namespace} "-DWORDS=${ARGN}" -P ${pcor_embed_script}
      WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
      DEPENDS ${files} ${pcor_embed_script}
      VERBATIM)
    target_sources(${target} PRIVATE ${output})
  endfunction()
  return()
endif()

set(body "")
set(separator "")
foreach(word IN LISTS WORDS)
  if(word MATCHES "[.]")
    file(READ ${word} text)
    string(APPEND body "R\"embedded(${text})embedded\"\n")
  else()
    string(APPEND body "${separator}extern const std::string_view ${word} =\n")
    set(separator ";\n\n")
  endif()
endforeach()
file(WRITE ${OUTPUT} "#include <string_view>\n\nnamespace ${NAMESPACE} {\n\n${body};\n\n}  // namespace ${NAMESPACE}\n")
