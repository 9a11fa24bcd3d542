# Headers of other libraries that most sources read, compiled once for all: half of the time of a build would go into them. They hold nothing of ours,
# so that a source still has to include what it uses of us, and nothing that nvcc compiles is given them.
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without; the preset `asan` does, which finds sources that lack an include.

# LINK: the libraries whose headers they are. OPTIONS: of all that uses them: what reads and writes text is compiled in up to a quarter less time with
# -O1, and the press scene with its pictures takes as long as before (6 steps: 21.8 CPU s, 22.1 with -O2). PROGRAM: for programs, whose code is
# position-independent in another way than that of libraries.
function(mortise_precompile name)
  cmake_parse_arguments(A "PROGRAM" "" "HEADERS;LINK;OPTIONS" ${ARGN})
  set(target mortise_headers_${name})
  file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp CONTENT "int main() {}\n")
  if(A_PROGRAM)
    add_executable(${target} ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp)
    set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  else()
    add_library(${target} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp)
  endif()
  target_link_libraries(${target} PUBLIC Eigen3::Eigen ${A_LINK})
  target_compile_options(${target} PRIVATE ${A_OPTIONS})
  set_property(GLOBAL PROPERTY ${target}_OPTIONS ${A_OPTIONS})
  target_precompile_headers(${target} PRIVATE <algorithm> <array> <cmath> <cstdint> <functional> <limits> <map> <memory> <optional> <set> <string>
                            <string_view> <utility> <vector> <Eigen/Core> <Eigen/Geometry> ${A_HEADERS})
endfunction()

function(mortise_use_precompiled target name)
  set(headers mortise_headers_${name})
  target_precompile_headers(${target} REUSE_FROM ${headers})
  get_property(options GLOBAL PROPERTY ${headers}_OPTIONS)
  target_compile_options(${target} PRIVATE ${options})
  # They are read only where what they saw defined is defined as well.
  target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:${headers},INTERFACE_COMPILE_DEFINITIONS>)
  # g++ 12 sees ghosts in std::string (its bug 105651), and no longer knows precompiled headers as the system's.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-array-bounds;-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread>)
endfunction()

# What runs kernels; what reads and writes text; tests.
mortise_precompile(engine OPTIONS $<$<CONFIG:Release>:-O3> HEADERS <tbb/blocked_range.h> <tbb/parallel_for.h> LINK TBB::tbb)
mortise_precompile(front OPTIONS $<$<CONFIG:Release>:-O1>
  HEADERS <chrono> <filesystem> <fstream> <iostream> <span> <sstream> <fmt/format.h> <nlohmann/json.hpp> LINK nlohmann_json::nlohmann_json fmt::fmt)
if(MORTISE_TESTS)
  find_package(GTest REQUIRED)
  mortise_precompile(tests PROGRAM OPTIONS $<$<CONFIG:Release>:-O1>
    HEADERS <fstream> <sstream> <random> <tbb/blocked_range.h> <tbb/parallel_for.h> <nlohmann/json.hpp> <gtest/gtest.h> <gmock/gmock.h>
    LINK TBB::tbb nlohmann_json::nlohmann_json GTest::gtest GTest::gmock)
endif()

# Sources of one folder are compiled several at a time: most of what a source costs is reading headers. So what
# they keep for themselves (unnamed namespaces) has names of its own in the folder. -DMORTISE_UNITY=OFF compiles each by itself.
option(MORTISE_UNITY "Compile the sources of a folder together" ON)
set(MORTISE_TOGETHER 8)  # sources: more gain little, and a change of one compiles them all
function(mortise_compile_together target)
  if(NOT MORTISE_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)  # it takes sources that are read together for headers
  foreach(source ${ARGN})
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR}/src ${folder})
    string(MAKE_C_IDENTIFIER ${folder} folder)
    math(EXPR count_${folder} "0${count_${folder}} + 1")
    math(EXPR group "(${count_${folder}} - 1) / ${MORTISE_TOGETHER}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${group})
  endforeach()
endfunction()
