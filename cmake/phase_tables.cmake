# Builds the phase tables of data/phase into `target`, each found by its file's name without ".txt".
function(thunderhead_embed_phase_tables target)
  set(root ${CMAKE_SOURCE_DIR}/data/phase)
  file(GLOB files CONFIGURE_DEPENDS RELATIVE ${root} ${root}/*.txt)
  list(SORT files)
  list(TRANSFORM files PREPEND ${root}/ OUTPUT_VARIABLE paths)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded_phase_tables.cc)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} "-DFILES=${files}" -DROOT=${root}
      -P ${CMAKE_SOURCE_DIR}/cmake/embed_phase_tables.cmake
    DEPENDS ${paths} ${CMAKE_SOURCE_DIR}/cmake/embed_phase_tables.cmake VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
