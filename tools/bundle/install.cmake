# Install rules and packages: a folder that runs wherever it is unpacked, on any Linux with glibc 2.36 or newer.
#
#   bin/ lib/ scenes/ schemas/ benchmarks/gpu/     component `program`: everything but pictures
#   lib/libmortise_render.so and what it needs     component `renderer` (OSMesa and LLVM)
#   bin/test_*, bin/mortise_judge, tests/          component `tests`, for benchmarks/gpu/run on another machine
#   licences/                                      of each: the texts of the libraries beside it and inside it (licences.cmake)
#
# Libraries beside the program are found through DT_RPATH=$ORIGIN/../lib, which also holds for what they need themselves; they are
# copied as they are. Only glibc, its loader and the NVIDIA driver come from the machine.
set(mortise_not_bundled PRE_EXCLUDE_REGEXES "^ld-linux" "^lib(c|m|pthread|dl|rt|resolv)\\.so" "^libcuda\\.so"
    POST_EXCLUDE_REGEXES "/ld-linux[^/]*$" "/lib(c|m|pthread|dl|rt|resolv)\\.so[^/]*$")

install(TARGETS mortise RUNTIME_DEPENDENCY_SET program_libraries RUNTIME DESTINATION bin COMPONENT program)
if(TARGET mortise_cuda)
  install(TARGETS mortise_cuda RUNTIME_DEPENDENCY_SET program_libraries LIBRARY DESTINATION lib COMPONENT program)
endif()
install(RUNTIME_DEPENDENCY_SET program_libraries ${mortise_not_bundled} LIBRARY DESTINATION lib COMPONENT program)
install(DIRECTORY scenes schemas DESTINATION . COMPONENT program)
install(DIRECTORY benchmarks/gpu DESTINATION benchmarks COMPONENT program USE_SOURCE_PERMISSIONS PATTERN results EXCLUDE)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION . COMPONENT program)

if(TARGET mortise_render_module)
  install(TARGETS mortise_render_module RUNTIME_DEPENDENCY_SET renderer_libraries LIBRARY DESTINATION lib COMPONENT renderer)
  install(RUNTIME_DEPENDENCY_SET renderer_libraries ${mortise_not_bundled} LIBRARY DESTINATION lib COMPONENT renderer)
endif()

if(MORTISE_TESTS)
  get_property(programs GLOBAL PROPERTY MORTISE_TEST_PROGRAMS)
  install(TARGETS ${programs} RUNTIME_DEPENDENCY_SET test_libraries RUNTIME DESTINATION bin COMPONENT tests)
  install(RUNTIME_DEPENDENCY_SET test_libraries ${mortise_not_bundled} LIBRARY DESTINATION lib COMPONENT tests)
  install(DIRECTORY tests/cli/bad DESTINATION tests/cli COMPONENT tests)
  install(DIRECTORY benchmarks DESTINATION . COMPONENT tests FILES_MATCHING PATTERN README.md)
endif()

# mortise_licences(COMPONENT [compiled-in package ...]): to be called behind the component's other rules.
function(mortise_licences component)
  install(CODE "set(place \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")\nset(compiled_in ${ARGN})\nset(more_texts ${more_texts})" COMPONENT ${component})
  install(SCRIPT tools/bundle/licences.cmake COMPONENT ${component})
endfunction()
set(headers libeigen3-dev libcli11-dev nlohmann-json3-dev libstb-dev libcgal-dev libboost1.74-dev)
set(more_texts "")
if(TARGET mortise_cuda)  # the CUDA runtime is inside the module
  get_filename_component(toolkit ${CMAKE_CUDA_COMPILER} REALPATH)
  get_filename_component(toolkit ${toolkit}/../.. ABSOLUTE)
  file(GLOB eula ${toolkit}/EULA.txt ${toolkit}/dist-info/nvidia_cuda_runtime-*/licenses/License.txt)
  list(APPEND eula ${toolkit}/EULA.txt)  # which then is missing
  list(GET eula 0 eula)
  set(more_texts "cuda-runtime=${eula}")
endif()
mortise_licences(program ${headers})
set(more_texts "")
if(TARGET mortise_render_module)
  mortise_licences(renderer fonts-dejavu-core libeigen3-dev)
endif()
if(MORTISE_TESTS)
  mortise_licences(tests ${headers} libgtest-dev)
endif()

set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # what a package holds is built by tools/bundle/make, not everything there is
set(CPACK_PACKAGE_NAME mortise)
set(CPACK_PACKAGE_VENDOR mortise)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_GENERATOR TXZ)
set(CPACK_SYSTEM_NAME linux-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)  # one archive per component; they unpack into the same folder
set(CPACK_COMPONENT_INCLUDE_TOPLEVEL_DIRECTORY ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
include(CPack)
