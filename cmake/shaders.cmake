# Embeds every .glsl, .vert, .frag and .comp file of server/shaders as a string. A shader is found by its path below
# that folder, for example "half_angle/eye.frag". Also generates shaders/uniforms.h, which makes the uniforms' names
# known to C++.
function(thunderhead_embed_shaders target)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}/server/shaders
    ${CMAKE_SOURCE_DIR}/server/shaders/*.glsl ${CMAKE_SOURCE_DIR}/server/shaders/*.vert
    ${CMAKE_SOURCE_DIR}/server/shaders/*.frag ${CMAKE_SOURCE_DIR}/server/shaders/*.comp)
  list(SORT files)
  list(TRANSFORM files PREPEND ${CMAKE_SOURCE_DIR}/server/shaders/ OUTPUT_VARIABLE paths)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded_shaders.cc)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} "-DFILES=${files}" -DROOT=${CMAKE_SOURCE_DIR}/server/shaders
      -P ${CMAKE_SOURCE_DIR}/cmake/embed_shaders.cmake
    DEPENDS ${paths} ${CMAKE_SOURCE_DIR}/cmake/embed_shaders.cmake VERBATIM)
  set(header ${CMAKE_BINARY_DIR}/generated/shaders/uniforms.h)
  add_custom_command(OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${header} "-DFILES=${files}" -DROOT=${CMAKE_SOURCE_DIR}/server/shaders
      -P ${CMAKE_SOURCE_DIR}/cmake/shader_uniforms.cmake
    DEPENDS ${paths} ${CMAKE_SOURCE_DIR}/cmake/shader_uniforms.cmake VERBATIM)
  target_sources(${target} PRIVATE ${output} ${header})
  add_custom_target(${target}_generated DEPENDS ${header})
  target_include_directories(${target} PUBLIC ${CMAKE_BINARY_DIR}/generated)
endfunction()
