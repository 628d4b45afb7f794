# Embeds the files of ROOT that match PATTERN into `target`. The function FUNCTION of NAMESPACE, which HEADER declares,
# returns each text by its name without extension.
function(thunderhead_embed_texts target)
  cmake_parse_arguments(TEXTS "" "ROOT;PATTERN;HEADER;NAMESPACE;FUNCTION" "" ${ARGN})
  file(GLOB files CONFIGURE_DEPENDS RELATIVE ${TEXTS_ROOT} ${TEXTS_ROOT}/${TEXTS_PATTERN})
  list(SORT files)
  list(TRANSFORM files PREPEND ${TEXTS_ROOT}/ OUTPUT_VARIABLE paths)
  get_filename_component(name ${TEXTS_HEADER} NAME_WE)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${name}.cc)
  set(script ${CMAKE_SOURCE_DIR}/cmake/embed_texts.cmake)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} "-DFILES=${files}" -DROOT=${TEXTS_ROOT} -DHEADER=${TEXTS_HEADER}
      -DNAMESPACE=${TEXTS_NAMESPACE} -DFUNCTION=${TEXTS_FUNCTION} -P ${script}
    DEPENDS ${paths} ${script} VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
