# thunderhead_third_party_notices(FILE packages...) writes FILE with the copyright files of Debian packages. These are
# the packages whose code becomes part of our programs, because they are header files or static libraries. Shared
# libraries are separate packages, which bring their own copyright files.
function(thunderhead_third_party_notices file)
  set(text "The program contains code of the Debian packages below. Their copyright files follow.\n")
  foreach(package ${ARGN})
    set(copyright /usr/share/doc/${package}/copyright)
    if(NOT EXISTS ${copyright})
      message(FATAL_ERROR "${copyright} is missing, and the program must be passed on with it. Install ${package} with its "
        "documentation.")
    endif()
    file(READ ${copyright} licence)
    string(REPEAT "=" 80 line)
    string(APPEND text "\n${line}\n${package}\n\n${licence}")
  endforeach()
  file(WRITE ${file} "${text}")
endfunction()
