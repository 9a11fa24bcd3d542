# Run while a component is installed: the licence text of every library in its lib/ and of everything compiled into its programs goes
# to licences/PACKAGE.txt. Packing fails where a library belongs to no package, or a package has no text.
#
#   place        folder of the component
#   compiled_in  packages whose headers, objects or data are inside the programs
#   more_texts   NAME=FILE, of what is no Debian package

function(add_text name file)
  if(NOT EXISTS "${file}")
    message(FATAL_ERROR "bundle: no licence text for ${name}: ${file} does not exist")
  endif()
  file(READ "${file}" text)
  file(WRITE "${place}/licences/${name}.txt" "${text}")
  # Debian's texts refer to the common ones by their place on a Debian machine.
  string(REGEX MATCHALL "/usr/share/common-licenses/[-.A-Za-z0-9]*[A-Za-z0-9]" common "${text}")
  list(REMOVE_DUPLICATES common)
  foreach(path ${common})
    if(EXISTS "${path}")
      get_filename_component(common_name "${path}" NAME)
      get_filename_component(path "${path}" REALPATH)
      configure_file("${path}" "${place}/licences/common/${common_name}" COPYONLY)
    endif()
  endforeach()
endfunction()

# The package that owns the library which the loader of this machine finds under a name.
function(package_of library out)
  set(${out} "" PARENT_SCOPE)
  file(GLOB found /usr/lib/*-linux-gnu/${library} /lib/*-linux-gnu/${library} /usr/lib/*-linux-gnu/*/${library} /usr/lib/*-linux-gnu/*/*/${library}
       /usr/lib/${library})
  foreach(path ${found})
    file(REAL_PATH "${path}" path)
    string(REGEX REPLACE "^/usr/lib/" "/lib/" unmerged "${path}")
    foreach(name "${path}" "${unmerged}")
      execute_process(COMMAND dpkg-query -S "${name}" OUTPUT_VARIABLE owner ERROR_QUIET RESULT_VARIABLE code)
      if(code EQUAL 0)
        string(REGEX REPLACE "[:,].*" "" owner "${owner}")
        set(${out} "${owner}" PARENT_SCOPE)
        return()
      endif()
    endforeach()
  endforeach()
endfunction()

set(packages ${compiled_in})
file(GLOB libraries RELATIVE "${place}/lib" "${place}/lib/*.so*")
foreach(library ${libraries})
  if(library MATCHES "^libmortise_" OR IS_SYMLINK "${place}/lib/${library}")
    continue()
  endif()
  package_of("${library}" package)
  if(package STREQUAL "")
    message(FATAL_ERROR "bundle: ${library} belongs to no package of this machine, so its licence is unknown")
  endif()
  list(APPEND packages "${package}")
endforeach()
list(REMOVE_DUPLICATES packages)
foreach(package ${packages})
  add_text("${package}" "/usr/share/doc/${package}/copyright")
endforeach()
foreach(text ${more_texts})
  string(REGEX MATCH "^([^=]*)=(.*)$" parts "${text}")
  add_text("${CMAKE_MATCH_1}" "${CMAKE_MATCH_2}")
endforeach()
